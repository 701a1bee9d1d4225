#include "integration/spy_screen.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <set>
#include <sstream>
#include <stdexcept>
#include <thread>

#include "support/paths.hpp"

namespace armcmc::test {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

template <typename Look>
void ForEachPixel(const Picture& picture, const Region& region, const Look& look) {
  const int x0 = static_cast<int>(region.x0 * picture.width), x1 = static_cast<int>(region.x1 * picture.width);
  const int y0 = static_cast<int>(region.y0 * picture.height), y1 = static_cast<int>(region.y1 * picture.height);
  for (int y = y0; y < y1; ++y) {
    for (int x = x0; x < x1; ++x) look(&picture.rgb[3 * static_cast<std::size_t>(y * picture.width + x)]);
  }
}

bool OnPath(const std::string& program) {
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');) {
    if (fs::exists(fs::path(folder) / program)) return true;
  }
  return false;
}

}  // namespace

int Picture::Count(const Rgb& colour, const Region& region) const {
  int n = 0;
  ForEachPixel(*this, region, [&](const std::uint8_t* p) {
    if (std::abs(p[0] - colour.r) + std::abs(p[1] - colour.g) + std::abs(p[2] - colour.b) < 50) ++n;
  });
  return n;
}

int Picture::Colours(const Region& region) const {
  std::set<int> colours;
  ForEachPixel(*this, region,
               [&](const std::uint8_t* p) { colours.insert((p[0] >> 4) << 8 | (p[1] >> 4) << 4 | p[2] >> 4); });
  return static_cast<int>(colours.size());
}

std::string SpyScreen::MissingTools() {
  std::string missing;
  for (const char* program : {"Xvfb", "xdotool", "import", "convert", "java", "lcm-logger"}) {
    if (!OnPath(program)) missing += std::string(missing.empty() ? "" : ", ") + program;
  }
  for (const fs::path& file :
       {fs::path("/usr/share/java/lcm.jar"), fs::path("/usr/share/java/jchart2d.jar"),
        Program("armcmc-spy").parent_path().parent_path() / "share" / "java" / "armcmc-spy.jar"}) {
    if (!fs::exists(file)) missing += (missing.empty() ? "" : ", ") + file.string();
  }
  if (missing.empty()) return "";
  return missing + " is not there: tools/install-dependencies --with spy --with spy-tests, then build again";
}

SpyScreen::SpyScreen()
    : server_(std::make_unique<Process>(
          "/usr/bin/env",
          std::vector<std::string>{"Xvfb", "-displayfd", "1", "-screen", "0", "2900x1850x24", "-nolisten", "tcp"})) {
  for (int i = 0; i < 200 && server_->out().find('\n') == std::string::npos; ++i) {
    std::this_thread::sleep_for(milliseconds(50));
  }
  std::istringstream number(server_->out());
  if (!std::getline(number, display_) || display_.empty()) throw std::runtime_error("Xvfb: " + server_->err());
  display_.insert(display_.begin(), ':');
}

Outcome SpyScreen::Run(std::vector<std::string> command) const {
  command.insert(command.begin(), "DISPLAY=" + display_);
  return RunProgram("/usr/bin/env", command);
}

void SpyScreen::Do(const std::vector<std::string>& command) const {
  const Outcome o = Run(command);
  if (o.code != 0) throw std::runtime_error(command.front() + ": " + o.err);
}

std::unique_ptr<Process> SpyScreen::StartSpy(const std::vector<std::string>& arguments) const {
  std::vector<std::string> command = {"DISPLAY=" + display_, Program("armcmc-spy").string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return std::make_unique<Process>("/usr/bin/env", command);
}

std::optional<std::string> SpyScreen::Window(const std::string& title) const {
  for (int i = 0; i < 80; ++i) {
    std::istringstream found(Run({"xdotool", "search", "--onlyvisible", "--name", "^" + title + "$"}).out);
    std::string window;
    if (std::getline(found, window) && !window.empty()) return window;
    std::this_thread::sleep_for(milliseconds(250));
  }
  return std::nullopt;
}

void SpyScreen::Place(const std::string& window, int x, int y, int width, int height) const {
  Do({"xdotool", "windowmove", window, std::to_string(x), std::to_string(y)});
  Do({"xdotool", "windowsize", window, std::to_string(width), std::to_string(height)});
}

void SpyScreen::DoubleClick(int x, int y) const {
  Do({"xdotool", "mousemove", std::to_string(x), std::to_string(y), "click", "--repeat", "2", "--delay", "80", "1"});
}

Picture SpyScreen::Shoot(const std::string& window, const std::string& name) const {
  const fs::path folder = Program("armcmc-spy").parent_path().parent_path() / "spy-screenshots";
  fs::create_directories(folder);
  const std::string png = (folder / (name + ".png")).string();
  Do({"import", "-window", window, png});
  const std::string ppm = png + ".ppm";
  Do({"convert", png, "-depth", "8", ppm});
  std::ifstream file(ppm, std::ios::binary);
  std::string magic;
  int depth = 0;
  Picture picture;
  file >> magic >> picture.width >> picture.height >> depth;
  file.get();
  picture.rgb.assign(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>());
  fs::remove(ppm);
  if (magic != "P6" || depth != 255 ||
      picture.rgb.size() != 3 * static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height)) {
    throw std::runtime_error(png + ": no picture");
  }
  return picture;
}

}  // namespace armcmc::test
