#include "services/console/service/page/page.hpp"

#include <initializer_list>

#include "common/base/html.hpp"

// The assembler takes the files in as they are: as an array in C++ they would compile for seconds.
__asm__(
    ".pushsection .rodata\n"
    "prehend_page_html: .incbin \"" PREHEND_PAGE
    "/page.html\"\n"
    "prehend_page_html_end:\n"
    "prehend_page_css: .incbin \"" PREHEND_PAGE
    "/built/page.css\"\n"
    "prehend_page_css_end:\n"
    "prehend_page_js: .incbin \"" PREHEND_PAGE
    "/built/page.js\"\n"
    "prehend_page_js_end:\n"
    "prehend_page_licences: .incbin \"" PREHEND_PAGE
    "/built/licences.txt\"\n"
    "prehend_page_licences_end:\n"
    ".popsection\n");
extern "C" const char prehend_page_html[], prehend_page_html_end[], prehend_page_css[],
    prehend_page_css_end[], prehend_page_js[], prehend_page_js_end[], prehend_page_licences[],
    prehend_page_licences_end[];

namespace prehend::console::page {

File file(std::string_view path) {
  if (path == "/page.js")
    return {"text/javascript; charset=utf-8", {prehend_page_js, prehend_page_js_end}};
  if (path == "/page.css")
    return {"text/css; charset=utf-8", {prehend_page_css, prehend_page_css_end}};
  return {"text/plain; charset=utf-8", {prehend_page_licences, prehend_page_licences_end}};
}

std::string html(std::string_view order_token, std::string_view no_hand) {
  std::string text(prehend_page_html, prehend_page_html_end);
  const auto put = [&](std::string_view place, std::string_view what) {
    if (const std::size_t at = text.find(place); at != std::string::npos)
      text.replace(at, place.size(), what);
  };
  put("ORDER_TOKEN", order_token);
  put("NO_HAND", html_escaped(no_hand));
  return text;
}

std::string_view tracking_type(std::string_view name) {
  // What services/console/service/page/hand-tracking/fetch brings.
  for (const auto& [type, file] : std::initializer_list<File>{
           {"text/javascript; charset=utf-8", "hands.js"},
           {"text/javascript; charset=utf-8", "hands_solution_packed_assets_loader.js"},
           {"text/javascript; charset=utf-8", "hands_solution_simd_wasm_bin.js"},
           {"application/wasm", "hands_solution_simd_wasm_bin.wasm"},
           {"application/octet-stream", "hands_solution_packed_assets.data"},
           {"application/octet-stream", "hands.binarypb"},
           {"application/octet-stream", "hand_landmark_full.tflite"},
           {"application/octet-stream", "hand_landmark_lite.tflite"}})
    if (file == name) return type;
  return {};
}

}  // namespace prehend::console::page
