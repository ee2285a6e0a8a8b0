#pragma once

#include <string>
#include <string_view>

/// The page, which is part of the program.
namespace prehend::console::page {

struct File {
  std::string_view type, text;
};

/// path: one of those that judge() lets through, as /page.js.
File file(std::string_view path);

/// The page itself. order_token: by which it gives orders; empty: it shows no buttons. no_hand: why
/// no hand that it tracks leads anything; empty: one may.
std::string html(std::string_view order_token, std::string_view no_hand);

/// Of a file of the hand tracking, which is no part of the program; empty: it is none.
std::string_view tracking_type(std::string_view name);

}  // namespace prehend::console::page
