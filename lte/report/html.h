// Self-contained HTML pages for reports: tables, embedded pictures, and the charts of chart.h. No
// script, no font and no other file is needed to read them.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace lte {

/// Text with &, <, > and quotes replaced by their entities.
std::string html_escape(const std::string& text);

/// RFC 4648, with padding.
std::string base64(std::span<const unsigned char> bytes);

/// A whole document; `body` is HTML.
std::string html_page(const std::string& title, const std::string& body);

/// Cells are text. The first column is set to the left, the others to the right; rows whose first
/// cell is `own` stand out.
std::string html_table(const std::vector<std::string>& head,
                       const std::vector<std::vector<std::string>>& rows,
                       const std::string& own = "");

/// A PNG file's bytes with a caption.
std::string html_picture(std::span<const unsigned char> png, const std::string& caption);

}  // namespace lte
