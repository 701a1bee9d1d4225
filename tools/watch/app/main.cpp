#include <langinfo.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <clocale>
#include <cstdlib>
#include <string>

#include "armcmc/support/program.hpp"
#include "armcmc/support/strict_toml.hpp"
#include "watch_loop.hpp"

namespace armcmc::watch {
namespace {

std::string DefaultUrl() {
  const char* url = std::getenv("LCM_DEFAULT_URL");
  return url != nullptr && *url != '\0' ? url : "udpm://239.255.76.67:7667?ttl=0";
}

void Declare(CLI::App* app, WatchOptions* options, bool* ascii) {
  options->url = DefaultUrl();
  app->add_option("--lcm-url", options->url, "LCM bus, the same as for the estimator")
      ->type_name("URL")
      ->capture_default_str();
  app->add_option("--prefix", options->prefix, "Prefix of the channel names, the same as for the estimator")
      ->type_name("P");
  app->add_option("--steps", options->steps, "Stop after this many steps")->type_name("N")->check(CLI::PositiveNumber);
  app->add_option("--duration", options->duration_s, "Stop after this many seconds")
      ->type_name("S")
      ->check(CLI::PositiveNumber);
  app->add_flag("--json", options->json, "One JSON object per step, even on a terminal");
  app->add_flag("--lines", options->lines, "One line per step, even on a terminal");
  app->add_flag("--ascii", *ascii, "No block characters (the default where the locale is not UTF-8)");
  app->footer(
      "Shows what a running estimator publishes: estimates, stage times against the deadline, missed deadlines, "
      "faults.\n"
      "Runs in a terminal; q or Ctrl-C quits. If standard output is not a terminal, it prints one line per step.\n"
      "NO_COLOR switches colours off.\n\n"
      "Example:\n"
      "  armcmc-watch --lcm-url 'udpm://239.255.76.67:7667?ttl=0'\n"
      "  armcmc-watch --json --steps 100 > steps.jsonl\n"
      "Exit status: 0 ok, 1 no step arrived within --duration or another failure, 2 bad usage.");
}

bool Utf8() {
  std::setlocale(LC_CTYPE, "");
  return std::string(nl_langinfo(CODESET)) == "UTF-8";
}

}  // namespace
}  // namespace armcmc::watch

int main(int argc, char** argv) {
  using namespace armcmc::watch;
  CLI::App app{"Watches a running estimator in a terminal."};
  WatchOptions options;
  bool ascii = false;
  Declare(&app, &options, &ascii);
  return armcmc::support::RunProgram(app, "armcmc-watch", argc, argv, [&] {
    options.screen = isatty(STDOUT_FILENO) != 0 && !options.json && !options.lines;
    options.glyphs = ascii || !Utf8() ? Glyphs::kAscii : Glyphs::kUnicode;
    const char* no_colour = std::getenv("NO_COLOR");
    options.colour = no_colour == nullptr || *no_colour == '\0';
    return Watch(options);
  });
}
