// Self-contained HTML pages for reports: tables and embedded pictures. No script, no font
// and no other file is needed to read them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace lte {

/// Text with &, <, > and quotes replaced by their entities.
std::string html_escape(const std::string& text);

/// RFC 4648, with padding.
std::string base64(std::span<const unsigned char> bytes);

/// A whole document, which fits any screen; `body` is HTML.
std::string html_page(const std::string& title, const std::string& body);

/// Cells are text. The first column is set to the left, the others to the right; rows whose first
/// cell is `own` stand out. A table that is wider than the page scrolls by itself.
std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows,
                       const std::string& own = "");

/// The same for sentences: cells are set to the left and wrap.
std::string html_text_table(const std::vector<std::string>& head,
                            const std::vector<std::vector<std::string>>& rows);

/// A PNG file's bytes with a caption, as wide as the page.
std::string html_picture(std::span<const unsigned char> png, const std::string& caption);

/// Pictures beside one another, as many as the page is wide for.
std::string html_grid(const std::string& content);

/// What is folded away until somebody wants it.
std::string html_details(const std::string& summary, const std::string& content);

/// The page's news in large letters. Empty for no text, as the two below.
std::string html_headline(const std::string& text);
/// A line that stands out as a warning.
std::string html_warning(const std::string& text);
/// A line in small letters.
std::string html_note(const std::string& text);

}  // namespace lte
