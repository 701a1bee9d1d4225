#include "gallery_page.hpp"

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "armcmc/gap/gallery.hpp"
#include "armcmc/support/program.hpp"

namespace armcmc::gap {

std::filesystem::path WriteGallery(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw support::InputError("--gallery " + folder.string() + ": is not a folder");
  std::vector<std::filesystem::path> results;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / "result.json") && std::filesystem::exists(entry.path() / "report.html"))
      results.push_back(entry.path() / "result.json");
  if (results.empty())
    throw support::InputError("--gallery " + folder.string() +
                              ": no folder in it holds result.json and report.html; make some with --out " +
                              (folder / "NAME").string());
  std::sort(results.begin(), results.end());
  std::vector<nlohmann::json> parsed;
  parsed.reserve(results.size());
  std::vector<GalleryEntry> entries;
  std::filesystem::path page = folder / "index.html";
  for (const std::filesystem::path& path : results) {
    try {
      std::ifstream file(path);
      parsed.push_back(nlohmann::json::parse(file));
      if (parsed.back().value("schema", 1) > 1)
        throw support::InputError(path.string() + ": schema = " + parsed.back().at("schema").dump() +
                                  ": expected 1; the file is of a newer version of the program");
      entries.push_back({path.parent_path().filename().string(), &parsed.back()});
      (void)GalleryHtml({entries.back()});  // reports which of them is incomplete
    } catch (const nlohmann::json::exception& error) {
      throw support::InputError(path.string() + ": is not a result of armcmc-gap: " + error.what());
    }
  }
  std::ofstream file(page, std::ios::binary);
  if (!(file << GalleryHtml(entries)) || !file.flush())
    throw support::InputError(page.string() + ": cannot be written");
  return page;
}

}  // namespace armcmc::gap
