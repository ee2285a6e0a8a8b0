// check_sbom FILE NAME: is this a bill of materials of NAME in SPDX 2.3? Every package that is
// named on standard input, one a line, must be in it, with a version and with what is known of its
// licence.
#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>

#include "common/base/file_text.hpp"

namespace {

using Json = nlohmann::json;

int faults = 0;

void require(bool condition, const std::string& what) {
  if (condition) return;
  std::cout << what << "\n";
  ++faults;
}

bool matches(const Json& object, const char* key, const std::string& form) {
  return object.contains(key) && object[key].is_string() &&
         std::regex_match(object[key].get<std::string>(), std::regex(form));
}

/// Every LicenseRef of the expression is explained.
void check_licences(const std::string& expression, const std::set<std::string>& explained) {
  static const std::regex form(R"((NOASSERTION|[A-Za-z0-9.-]+( AND [A-Za-z0-9.-]+)*))");
  require(std::regex_match(expression, form), "no licence expression: " + expression);
  static const std::regex reference("LicenseRef-[A-Za-z0-9.-]+");
  for (std::sregex_iterator at(expression.begin(), expression.end(), reference), end; at != end;
       ++at)
    require(explained.contains(at->str()), at->str() + " is not explained");
}

void check_document(const Json& bill, const std::string& name) {
  require(bill.value("spdxVersion", "") == "SPDX-2.3", "is not of SPDX 2.3");
  require(bill.value("dataLicense", "") == "CC0-1.0", "dataLicense is not CC0-1.0");
  require(bill.value("SPDXID", "") == "SPDXRef-DOCUMENT", "the document has another SPDXID");
  require(bill.value("name", "").starts_with(name + "-"), "is not of " + name);
  require(matches(bill, "documentNamespace", "[a-z]+:[^#\\s]+"), "has no namespace");
  const Json made = bill.value("creationInfo", Json::object());
  require(matches(made, "created", R"(\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ)"), "has no date");
  require(made.contains("creators") && !made["creators"].empty(), "has no creator");
}

void check_package(const Json& package, std::set<std::string>& ids,
                   const std::set<std::string>& explained) {
  const std::string what = package.dump();
  require(matches(package, "SPDXID", "SPDXRef-[A-Za-z0-9.-]+"), "no SPDXID: " + what);
  require(ids.insert(package.value("SPDXID", "")).second, "is there twice: " + what);
  for (const char* key : {"name", "versionInfo", "downloadLocation", "licenseConcluded"})
    require(matches(package, key, ".+"), fmt::format("no {}: {}", key, what));
  check_licences(package.value("licenseDeclared", ""), explained);
  if (package.value("SPDXID", "") == "SPDXRef-Product") return;
  require(matches(package, "licenseComments", "[^\\x00-\\x1f]+"), "no word on licences: " + what);
  const Json links = package.value("externalRefs", Json::array());
  require(links.size() == 1 &&
              matches(links[0], "referenceLocator",
                      R"(pkg:deb/debian/[a-z0-9.%A-F-]+@[A-Za-z0-9.~%-]+\?arch=[a-z0-9]+)"),
          "no package URL: " + what);
}

void check_relations(const Json& bill, const std::set<std::string>& ids) {
  std::set<std::string> related;
  for (const Json& relation : bill.value("relationships", Json::array())) {
    const std::string from = relation.value("spdxElementId", ""),
                      to = relation.value("relatedSpdxElement", "");
    require(from == "SPDXRef-DOCUMENT" || ids.contains(from),
            "relation of nothing: " + relation.dump());
    require(ids.contains(to), "relation to nothing: " + relation.dump());
    related.insert(to);
  }
  require(related == ids, "some packages are related to nothing");
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "check_sbom FILE NAME\n";
    return 2;
  }
  const auto text = prehend::read_file(argv[1]);
  const Json bill = text ? Json::parse(*text, nullptr, false) : Json();
  if (!bill.is_object()) {
    std::cout << argv[1] << ": is no JSON object\n";
    return 1;
  }
  check_document(bill, argv[2]);
  std::set<std::string> explained, ids, names;
  for (const Json& licence : bill.value("hasExtractedLicensingInfos", Json::array())) {
    require(!licence.value("extractedText", "").empty(), "a licence without a text");
    explained.insert(licence.value("licenseId", ""));
  }
  for (const Json& package : bill.value("packages", Json::array())) {
    check_package(package, ids, explained);
    names.insert(package.value("name", ""));
  }
  check_relations(bill, ids);
  std::size_t wanted = 0;
  for (std::string name; std::getline(std::cin, name); ++wanted)
    require(names.contains(name), name + " is not listed");
  std::cout << fmt::format("{}: {} packages, {} of them asked for, {} faults\n", argv[2],
                           names.size(), wanted, faults);
  return faults == 0 ? 0 : 1;
}
