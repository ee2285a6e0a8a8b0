#include "common/proto/sealed_file.hpp"

#include <fmt/format.h>
#include <openssl/sha.h>
#include <unistd.h>

#include <array>

#include "common/base/file_text.hpp"

namespace prehend::proto {
namespace {

constexpr std::string_view version = "1";

}  // namespace

std::string digest(std::string_view bytes) {
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash;
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), hash.data());
  return fmt::format("{:02x}", fmt::join(hash, ""));
}

std::string seal(std::string_view kind, std::string_view bytes) {
  const std::string head = fmt::format("prehend {} {}\n", kind, version);
  // The digest covers the head too, so that no byte of the file can change unseen.
  return head + digest(head + std::string(bytes)) + "\n" + std::string(bytes);
}

Expected<std::string> unseal(std::string_view sealed, std::string_view kind) {
  const std::size_t first = sealed.find('\n');
  const std::string head = fmt::format("prehend {} {}\n", kind, version);
  if (first == std::string_view::npos || first > 128 || !sealed.starts_with("prehend "))
    return fail("is nothing that prehend wrote, or its first line is damaged");
  if (sealed.substr(0, first + 1) != head)
    return fail(fmt::format("holds '{}', not '{}'", sealed.substr(0, first),
                            std::string_view(head).substr(0, head.size() - 1)));
  const std::size_t body = first + 1 + 2 * SHA256_DIGEST_LENGTH + 1;
  if (sealed.size() < body || sealed[body - 1] != '\n') return fail("is cut short");
  const std::string bytes(sealed.substr(body));
  if (digest(head + bytes) != sealed.substr(first + 1, 2 * SHA256_DIGEST_LENGTH))
    return fail("is damaged: its digest does not fit");
  return bytes;
}

Expected<void> write_sealed(const std::filesystem::path& file, std::string_view kind,
                            std::string_view bytes) {
  std::error_code ignored;
  if (file.has_parent_path()) std::filesystem::create_directories(file.parent_path(), ignored);
  return write_file(file, seal(kind, bytes));
}

Expected<std::string> read_sealed(const std::filesystem::path& file, std::string_view kind) {
  const auto sealed = read_file(file);
  if (!sealed) return tl::unexpected(sealed.error());
  auto bytes = unseal(*sealed, kind);
  if (!bytes) return fail(bytes.error().what, file.string(), "make it again");
  return bytes;
}

}  // namespace prehend::proto
