#include "lte/report/html.h"

#include "lte/base/check.h"

namespace lte {
namespace {

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:1180px;margin:2em auto;padding:0 1em;"
    "color:#222}h1{font-size:1.6em}h2{margin-top:1.8em;border-bottom:1px solid #ddd}"
    "table{border-collapse:collapse;margin:1em 0}td,th{padding:.25em .8em;text-align:right;"
    "border-bottom:1px solid #eee}td:first-child,th:first-child{text-align:left}"
    "tr.own{background:#eef6ff;font-weight:600}figure{margin:.6em 0}"
    "img{max-width:100%;image-rendering:pixelated;border:1px solid #ccc}"
    "figcaption{font-size:.85em;color:#555}.note{color:#555;font-size:.9em}"
    "svg{background:#fafafa;border:1px solid #ddd;margin:.3em}svg text{font:11px sans-serif}";

std::string row(const std::vector<std::string>& cells, const char* tag, bool own) {
  std::string out = own ? "<tr class=own>" : "<tr>";
  for (const std::string& cell : cells)
    out += concat("<", tag, ">", html_escape(cell), "</", tag, ">");
  return out + "</tr>\n";
}

}  // namespace

std::string html_escape(const std::string& text) {
  std::string out;
  for (const char letter : text) {
    switch (letter) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      case '\'':
        out += "&#39;";
        break;
      default:
        out += letter;
    }
  }
  return out;
}

std::string base64(std::span<const unsigned char> bytes) {
  constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (size_t i = 0; i < bytes.size(); i += 3) {
    const size_t count = std::min<size_t>(3, bytes.size() - i);
    uint32_t word = 0;
    for (size_t k = 0; k < 3; ++k) word = word << 8 | (k < count ? bytes[i + k] : 0U);
    for (size_t k = 0; k < 4; ++k) out += k <= count ? kDigits[word >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string html_page(const std::string& title, const std::string& body) {
  return concat("<!doctype html>\n<html lang=en><meta charset=utf-8><title>", html_escape(title),
                "</title>\n<style>", kStyle, "</style>\n<h1>", html_escape(title), "</h1>\n", body,
                "</html>\n");
}

std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows, const std::string& own) {
  std::string out = "<table>\n" + row(head, "th", false);
  for (const std::vector<std::string>& cells : rows)
    out += row(cells, "td", !own.empty() && !cells.empty() && cells.front() == own);
  return out + "</table>\n";
}

std::string html_picture(std::span<const unsigned char> png, const std::string& caption) {
  return concat("<figure><img alt=\"", html_escape(caption), "\" src=\"data:image/png;base64,",
                base64(png), "\"><figcaption>", html_escape(caption), "</figcaption></figure>\n");
}

}  // namespace lte
