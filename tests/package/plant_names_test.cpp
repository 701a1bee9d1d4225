// The engine knows roles and slots, and no plant by name: what belongs to one plant is in its own folders,
// plants/NAME/ of core and of the other parts of the tree that have something of their own for it.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "support/paths.hpp"

namespace armcmc::test::plant_names_test {
namespace {

namespace fs = std::filesystem;

/// Lower case, without what may stand between the words of a name: "Hunt-Crossley" becomes "huntcrossley".
std::string Spoken(std::string_view text) {
  std::string spoken;
  for (const char c : text)
    if (c != ' ' && c != '_' && c != '-') spoken += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return spoken;
}

/// Whether a line names the plant `name`, in any spelling. A name of one word is a word of the language, too: it counts
/// as a text or as a folder.
bool Names(std::string_view line, const std::string& name) {
  if (name.find('_') != std::string::npos) return Spoken(line).find(Spoken(name)) != std::string::npos;
  return line.find('"' + name + '"') != std::string_view::npos ||
         line.find("plants/" + name + "/") != std::string_view::npos;
}

std::vector<std::string> Plants() {
  std::vector<std::string> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(SourceDir() / "core/plants"))
    if (entry.is_directory()) names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

/// The list of the plants that have a folder in this part of the tree.
bool IsList(const fs::path& file) {
  return file.parent_path().filename() == "plants" && (file.stem() == "registry" || file.filename() == "kernels.inl");
}

bool IsInFolderOf(const fs::path& file, const std::string& plant) {
  return file.generic_string().find("/plants/" + plant + "/") != std::string::npos;
}

TEST(PlantNames, AreFoundInEverySpelling) {
  for (const char* line : {"#include \"plants/big_tank/model.hpp\"", "struct BigTank {", "data_pack_t::PLANT_BIG_TANK",
                           "/// A big tank.", "name == \"big_tank\"", "// Big-Tank"})
    EXPECT_TRUE(Names(line, "big_tank")) << line;
  EXPECT_FALSE(Names("a big drum", "big_tank"));
  EXPECT_TRUE(Names("from = \"tank\"", "tank"));
  EXPECT_FALSE(Names("the tank is full", "tank"));
}

TEST(PlantNames, AppearOnlyInTheirFolders) {
  const std::vector<std::string> plants = Plants();
  ASSERT_GE(plants.size(), 2U);
  int files = 0;
  for (const char* part : {"core", "rt", "tools", "plant_sim"})
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(SourceDir() / part)) {
      const std::set<std::string> code = {".hpp", ".cpp", ".inl"};
      if (!entry.is_regular_file() || !code.contains(entry.path().extension())) continue;
      const fs::path path = fs::relative(entry.path(), SourceDir());
      if (IsList(path)) continue;
      ++files;
      std::ifstream text(entry.path());
      std::string line;
      for (int number = 1; std::getline(text, line); ++number)
        for (const std::string& plant : plants) {
          if (IsInFolderOf(path, plant) || !Names(line, plant)) continue;
          ADD_FAILURE() << path.generic_string() << ':' << number << ": names " << plant
                        << " outside its folders: " << line;
        }
    }
  EXPECT_GT(files, 300);
}

}  // namespace
}  // namespace armcmc::test::plant_names_test
