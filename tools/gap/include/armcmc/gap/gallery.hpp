#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace armcmc::gap {

/// One result in a gallery.
struct GalleryEntry {
  std::string folder;            ///< Folder with report.html, relative to the page.
  const nlohmann::json* result;  ///< Content of result.json.
};

/// One page that links the reports of several recordings, with the named effects, the errors before and after, and the
/// remainder of each. Text of the results is escaped.
/// @throws nlohmann::json::exception if a result lacks a key.
[[nodiscard]] std::string GalleryHtml(const std::vector<GalleryEntry>& entries);

}  // namespace armcmc::gap
