#include "lte/report/html.h"

#include "lte/base/check.h"
#include "lte/report/style.h"  // generated from style.css: kStyle

namespace lte {
namespace {

std::string paragraph(const char* kind, const std::string& text) {
  return text.empty() ? "" : concat("<p class=", kind, ">", html_escape(text), "</p>\n");
}

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
  return concat(
      "<!doctype html>\n<html lang=en><meta charset=utf-8>\n"
      "<meta name=viewport content=\"width=device-width, initial-scale=1\">\n<title>",
      html_escape(title), "</title>\n<style>", kStyle, "</style>\n<h1>", html_escape(title),
      "</h1>\n", body, "</html>\n");
}

std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows, const std::string& own) {
  std::string out = "<div class=scroll><table>\n" + row(head, "th", false);
  for (const std::vector<std::string>& cells : rows)
    out += row(cells, "td", !own.empty() && !cells.empty() && cells.front() == own);
  return out + "</table></div>\n";
}

std::string html_text_table(const std::vector<std::string>& head,
                            const std::vector<std::vector<std::string>>& rows) {
  return "<div class=text>" + html_table(head, rows) + "</div>\n";
}

std::string html_picture(std::span<const unsigned char> png, const std::string& caption) {
  return concat("<figure><img alt=\"", html_escape(caption), "\" src=\"data:image/png;base64,",
                base64(png), "\"><figcaption>", html_escape(caption), "</figcaption></figure>\n");
}

std::string html_grid(const std::string& content) {
  return concat("<div class=grid>\n", content, "</div>\n");
}

std::string html_details(const std::string& summary, const std::string& content) {
  return concat("<details><summary>", html_escape(summary), "</summary>\n", content,
                "</details>\n");
}

std::string html_headline(const std::string& text) { return paragraph("headline", text); }
std::string html_warning(const std::string& text) { return paragraph("warning", text); }
std::string html_note(const std::string& text) { return paragraph("note", text); }

}  // namespace lte
