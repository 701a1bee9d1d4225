#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace armcmc::gap {

/// One result in a gallery.
struct GalleryEntry {
  std::string folder;            ///< That holds report.html, relative to the page.
  const nlohmann::json* result;  ///< What result.json says.
};

/// One page that links the reports of several recordings: what was named of each, what it takes off the error, what is
/// left. Text of the results is escaped.
/// @throws nlohmann::json::exception where a result lacks a key.
[[nodiscard]] std::string GalleryHtml(const std::vector<GalleryEntry>& entries);

}  // namespace armcmc::gap
