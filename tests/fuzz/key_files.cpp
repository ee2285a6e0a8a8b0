// Damaged files of a key: certificates, revocation lists, signed texts, permissions. Nothing that
// was altered may count as signed by the authority, and permissions say what is read from them.
#include "common/dds/permissions.hpp"
#include "common/keys/certificate.hpp"
#include "tests/fuzz/fuzz.hpp"
#include "tests/fuzz/mutation.hpp"

using namespace prehend;

namespace {

std::string without_returns(std::string text) {
  std::erase(text, '\r');
  return text;
}

}  // namespace

int main(int argc, char** argv) {
  const Time now = from_ns(1'800'000'000'000'000'000);
  const keys::Validity valid{now, now + std::chrono::days(10)};
  const keys::Identity authority = *keys::make_authority("lab", valid);
  const keys::Identity glove = *keys::issue(authority, "glove", {}, valid);
  const std::string serial = keys::facts(glove.certificate)->serial;
  const std::string list = *keys::revocation_list(authority, {{serial, now}}, valid);
  dds::Permissions permissions = dds::min_permissions(dds::Role::glove);
  permissions.subject = "CN=glove";
  permissions.from = permissions.until = "2027-01-01T00:00:00";
  permissions.scope = *dds::scope_of("left", 7);
  const std::string text = dds::text(permissions);

  // The first letter says which file it is.
  fuzz::Fuzzer fuzzer;
  fuzzer.seeds = {"C" + glove.certificate, "L" + list, "S" + *keys::sign(authority, text),
                  "P" + text};
  fuzzer.mutate = [](Random& random, std::string file) {
    const std::string kind = file.substr(0, 1);
    file.erase(0, 1);
    return kind + (kind == "P" ? fuzz::mutate_text(random, std::move(file), fuzz::mutate_xml)
                               : fuzz::mutate_bytes(random, std::move(file)));
  };
  fuzzer.target = [&](const std::string& input) {
    const std::string file = input.substr(1);
    switch (input[0]) {
      case 'C': {
        const auto facts = keys::facts(file);
        const bool good =
            keys::check({file, glove.key}, authority.certificate, list, now).has_value();
        fuzz::require(!good, "a revoked certificate counts");
        return facts.has_value();
      }
      case 'L': {
        const auto gone = keys::revoked(file, authority.certificate);
        fuzz::require(!gone || (gone->size() == 1 && gone->front().serial == serial),
                      "an altered list counts");
        return gone.has_value();
      }
      case 'S': {
        const auto content = keys::verified(file, authority.certificate);
        fuzz::require(!content || without_returns(*content) == text, "an altered text counts");
        return content.has_value();
      }
      default: {
        const auto read = dds::read_permissions(file);
        fuzz::require(!read || without_returns(dds::text(*read)) == without_returns(file),
                      "permissions say something else");
        return read.has_value();
      }
    }
  };
  return fuzz::run(fuzzer, argc, argv);
}
