#include <CLI/CLI.hpp>
#include <cstdio>
#include <iostream>
#include <string>

#include "armcmc/log_export/log_export.hpp"
#include "armcmc/support/printable.hpp"
#include "armcmc/support/program.hpp"
#include "armcmc/support/progress.hpp"
#include "armcmc/support/text_table.hpp"

namespace armcmc::log_export {
namespace {

struct Arguments {
  ExportRequest request;
  std::string format = "csv";
  std::string histograms = "wide";
};

void Declare(CLI::App* app, Arguments* a) {
  app->add_option("--data", a->request.log, "LCM log, as lcm-logger writes it")->type_name("FILE")->required();
  app->add_option("--out", a->request.out, "Folder for the tables, one CSV per channel; with --format mcap the file")
      ->type_name("PATH")
      ->required();
  app->add_option("--format", a->format, "csv, or mcap: one file for Foxglove and PlotJuggler")
      ->type_name("FORMAT")
      ->check(CLI::IsMember({"csv", "mcap"}))
      ->capture_default_str();
  app->add_option("--channels", a->request.channels,
                  "Only these channels, comma separated, with or without their prefix (EST_ESTIMATE)")
      ->type_name("NAME")
      ->delimiter(',');
  app->add_option("--prefix", a->request.prefix, "Only channels with this prefix")->type_name("P");
  app->add_option("--histograms", a->histograms,
                  "Posteriors in CSV: wide, one row per message (PlotJuggler), or long, one row per bin (pandas)")
      ->type_name("SHAPE")
      ->check(CLI::IsMember({"wide", "long"}))
      ->capture_default_str();
  app->footer(
      "Converts a log to tables for PlotJuggler and pandas. The first column is the time in seconds since the first\n"
      "event of the log; headers include units: \"ar_map.K [N m^-p]\". Each sample of a pack has its own row.\n"
      "A number that is not finite, such as the zeta of the first pack, is an empty cell.\n\n"
      "With --format mcap the rows are JSON messages in one MCAP file, with a topic for each channel and the units in\n"
      "the schemas. JSON cannot represent infinity or NaN: such values become null.\n\n"
      "Examples:\n"
      "  armcmc-export --data run.lcm --out tables --channels EST_ESTIMATE,PLANT_PACK\n"
      "  python3 -c \"import pandas; print(pandas.read_csv('tables/EST_ESTIMATE.csv', index_col='t "
      "[s]').describe())\"\n"
      "  armcmc-export --data run.lcm --format mcap --out run.mcap\n"
      "Exit status: 0 ok, 2 bad usage or input, 1 any other failure.");
}

std::string Hex(std::int64_t fingerprint) {
  char text[20];
  std::snprintf(text, sizeof text, "%016llx", static_cast<unsigned long long>(fingerprint));
  return text;
}

void Print(const ExportSummary& summary) {
  support::TextTable table({"channel", "type", "messages", "rows", "undecodable", "file"});
  for (const ExportedTable& t : summary.tables)
    table.AddRow({t.channel.name, t.channel.type->name, std::to_string(t.channel.messages), std::to_string(t.rows),
                  std::to_string(t.channel.undecodable), t.file.string()});
  std::cout << table.ToString();
  for (const ChannelScan& channel : summary.foreign)
    std::cout << "foreign: " << support::Printable(channel.name) << ", " << channel.undecodable << " events of type "
              << Hex(channel.fingerprint) << " (not a released type of this project)\n";
  if (summary.left_out > 0) std::cout << summary.left_out << " channels were not requested\n";
  if (summary.damage.any()) std::cout << "the log is damaged: " << ToString(summary.damage) << '\n';
}

int Run(const Arguments& arguments) {
  ExportRequest request = arguments.request;
  if (arguments.format == "mcap") request.format = ExportFormat::kMcap;
  request.long_histograms = arguments.histograms == "long";
  if (request.long_histograms && request.format == ExportFormat::kMcap)
    throw support::InputError("--histograms long: makes rows of a CSV table, not of --format mcap");
  ExportSummary summary;
  {
    support::Progress progress("export");
    summary = ExportLog(request, [&](double share) { progress.Update(share); });
  }
  Print(summary);
  return support::kExitOk;
}

}  // namespace
}  // namespace armcmc::log_export

int main(int argc, char** argv) {
  CLI::App app{"Converts an LCM log to CSV tables, one per channel, or to one MCAP file."};
  armcmc::log_export::Arguments arguments;
  armcmc::log_export::Declare(&app, &arguments);
  return armcmc::support::RunProgram(app, "armcmc-export", argc, argv,
                                     [&] { return armcmc::log_export::Run(arguments); });
}
