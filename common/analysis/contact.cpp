#include "common/analysis/contact.hpp"

#include <algorithm>
#include <limits>

namespace prehend::analysis {

std::vector<Contact> spread_contacts(const std::vector<Contact>& contacts, std::size_t most) {
  if (contacts.size() <= most) return contacts;
  std::vector<Contact> chosen;
  if (most == 0) return chosen;
  std::vector<double> distance(contacts.size(), std::numeric_limits<double>::infinity());
  auto next = static_cast<std::size_t>(
      std::max_element(contacts.begin(), contacts.end(),
                       [](const Contact& a, const Contact& b) { return a.force < b.force; }) -
      contacts.begin());
  while (chosen.size() < most) {
    chosen.push_back(contacts[next]);
    for (std::size_t i = 0; i < contacts.size(); ++i)
      distance[i] = std::min(distance[i], (contacts[i].p_OC - contacts[next].p_OC).squaredNorm());
    next = static_cast<std::size_t>(std::max_element(distance.begin(), distance.end()) -
                                    distance.begin());
  }
  return chosen;
}

}  // namespace prehend::analysis
