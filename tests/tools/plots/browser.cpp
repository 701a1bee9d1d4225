#include "tools/plots/browser.hpp"

#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <regex>
#include <sstream>
#include <stdexcept>

#include "support/paths.hpp"
#include "support/process.hpp"

namespace armcmc::test {
namespace {

// Runs in the page after everything else: goes through the sizes of a print, plays a reader who points, zooms and hides
// curves, then counts what can be seen. Curves are
// the only saturated colours on a canvas; grid, axes and words are grey. Nearly clear pixels can have any colour.
constexpr const char* kProbe = R"JS(<script>
addEventListener('load', () => {
  dispatchEvent(new Event('beforeprint'));
  dispatchEvent(new Event('afterprint'));
  const mouse = (element, type, x) => element.dispatchEvent(new MouseEvent(type,
    {bubbles: true, cancelable: true, view: window, button: 0, clientX: element.getBoundingClientRect().left + x,
     clientY: element.getBoundingClientRect().top + 50}));
  document.querySelectorAll('.u-over').forEach((over) => {
    mouse(over, 'mousemove', 100), mouse(over, 'mousedown', 100), mouse(over, 'mousemove', 300);
    mouse(over, 'mouseup', 300), mouse(over, 'dblclick', 300);
  });
  document.querySelectorAll('.legend button').forEach((button) => { button.click(), button.click(); });
  document.querySelectorAll('.cell').forEach((cell) => {
    cell.dispatchEvent(new PointerEvent('pointerenter')), cell.dispatchEvent(new PointerEvent('pointerleave'));
  });
  setTimeout(() => {
    document.querySelectorAll('figure.chart').forEach((figure) => {
      let marks = figure.querySelectorAll('svg .cell').length;
      figure.querySelectorAll('canvas').forEach((canvas) => {
        const {data} = canvas.getContext('2d').getImageData(0, 0, canvas.width, canvas.height);
        for (let i = 0; i < data.length; i += 4) {
          const [r, g, b] = [data[i], data[i + 1], data[i + 2]];
          if (data[i + 3] > 60 && Math.max(r, g, b) - Math.min(r, g, b) > 60) ++marks;
        }
      });
      figure.dataset.marks = marks;
    });
    document.documentElement.dataset.probed = 'yes';
  }, 300);
});
</script>)JS";

std::string WithProbe(std::string html) {
  const std::size_t end = html.rfind("</body>");
  if (end == std::string::npos) throw std::runtime_error("View: the page has no </body>");
  return html.insert(end, kProbe);
}

std::string Attribute(const std::string& tag, const std::string& name) {
  std::smatch match;
  return std::regex_search(tag, match, std::regex(name + "=\"([^\"]*)\"")) ? match[1].str() : "";
}

std::vector<std::string> Tags(const std::string& dom, const std::string& start) {
  std::vector<std::string> tags;
  for (std::size_t at = dom.find(start); at != std::string::npos; at = dom.find(start, at + 1))
    tags.push_back(dom.substr(at, dom.find('>', at) - at));
  return tags;
}

}  // namespace

std::optional<std::filesystem::path> FindBrowser() {
  if (const char* chosen = std::getenv("ARMCMC_BROWSER")) return chosen;
  const char* path = std::getenv("PATH");
  std::istringstream folders(path == nullptr ? "" : path);
  for (std::string folder; std::getline(folders, folder, ':');)
    for (const char* name : {"chromium", "chromium-headless-shell", "google-chrome"})
      if (const auto file = std::filesystem::path(folder) / name; access(file.c_str(), X_OK) == 0) return file;
  return std::nullopt;
}

BrowserView View(const std::string& html) {
  const ScratchDir scratch;
  const std::filesystem::path page = scratch / "page.html";
  std::ofstream(page) << WithProbe(html);
  // The sandbox of the browser needs rights that containers do not give; the page is our own.
  const Outcome outcome =
      RunProgram(FindBrowser().value(),
                 {"--headless", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--no-first-run",
                  "--disable-lcd-text", "--host-resolver-rules=MAP * ~NOTFOUND",
                  "--user-data-dir=" + (scratch / "profile").string(), "--enable-logging=stderr",
                  "--window-size=1400,900", "--virtual-time-budget=10000", "--dump-dom", "file://" + page.string()},
                 std::chrono::seconds(100));
  if (outcome.code != 0)
    throw std::runtime_error("the browser ended with " + std::to_string(outcome.code) + ":\n" + outcome.err);

  BrowserView view{{}, {}, outcome.out};
  std::istringstream lines(outcome.err);
  for (std::string line; std::getline(lines, line);)
    if (line.find("CONSOLE") != std::string::npos) view.complaints.push_back(line);
  const std::vector<std::string> roots = Tags(view.dom, "<html");
  if (roots.empty() || Attribute(roots.front(), "data-probed") != "yes")
    throw std::runtime_error("the browser did not come to the end of the page:\n" + outcome.err);
  if (const std::string errors = Attribute(roots.front(), "data-errors"); !errors.empty())
    view.complaints.push_back(errors);
  for (const std::string& tag : Tags(view.dom, "<figure class=\"chart\""))
    view.figures.push_back({Attribute(tag, "data-kind"), Attribute(tag, "data-drawn") == "yes",
                            std::atol(Attribute(tag, "data-marks").c_str())});
  return view;
}

}  // namespace armcmc::test
