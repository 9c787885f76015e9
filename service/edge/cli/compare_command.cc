#include <algorithm>
#include <atomic>
#include <cctype>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "service/edge/cli/commands.h"
#include "service/edge/files/bitmap.h"
#include "service/edge/files/file.h"
#include "service/match/outline_word.h"
#include "service/outline/region.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

constexpr double kMinShapeArea_px = 12.0;

struct CompareArguments {
  fs::path folder;
  fs::path out;
  bool tells_mirrored = false;
};

/// Calls `work(0)` to `work(count - 1)`, on all cores.
template <class Work>
void ForEachIndex(std::size_t count, const Work& work) {
  std::atomic<std::size_t> next = 0;
  const auto take_next = [&] {
    for (std::size_t i = next++; i < count; i = next++) work(i);
  };
  std::vector<std::jthread> threads(std::max(1u, std::thread::hardware_concurrency()));
  for (std::jthread& thread : threads) thread = std::jthread(take_next);
}

bool IsPicture(const fs::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg" || extension == ".gif";
}

Result<std::vector<fs::path>> ListFiles(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> files;
  for (fs::directory_iterator entry(folder, error); !error && entry != fs::directory_iterator();
       entry.increment(error)) {
    if (entry->is_regular_file() && IsPicture(entry->path())) files.push_back(entry->path());
  }
  if (error) return InvalidInput(folder.string() + ": " + error.message());
  if (files.empty()) return InvalidInput(folder.string() + " has no pictures (png, jpg, jpeg, gif)");
  std::sort(files.begin(), files.end());
  return files;
}

/// The greatest shape of a bitmap: what differs from most of the picture's edge.
Result<OutlineWord> ReadWord(const fs::path& file) {
  const Result<cv::Mat1b> read = ReadBitmapFile(file);
  if (!read.ok()) return read.error();
  const cv::Mat1b& bitmap = read.value();
  cv::Mat1b is_bright, is_shape;
  cv::compare(bitmap, 128.0, is_bright, cv::CMP_GE);
  std::size_t edge = 0, bright = 0;
  for (const cv::Mat1b& side : {is_bright.row(0), is_bright.row(is_bright.rows - 1), is_bright.col(0),
                                is_bright.col(is_bright.cols - 1)}) {
    edge += side.total();
    bright += static_cast<std::size_t>(cv::countNonZero(side));
  }
  cv::compare(is_bright, 2 * bright < edge ? 255.0 : 0.0, is_shape, cv::CMP_EQ);
  const std::vector<Region> regions = TraceRegions(is_shape, kMinShapeArea_px);
  if (regions.empty()) return InvalidInput(file.string() + " shows no shape");
  return SpellOutline(regions.front().boundary);
}

Result<std::vector<OutlineWord>> ReadWords(const std::vector<fs::path>& files) {
  std::vector<std::optional<Result<OutlineWord>>> read(files.size());
  ForEachIndex(files.size(), [&](std::size_t i) { read[i] = ReadWord(files[i]); });
  std::vector<OutlineWord> words;
  for (const auto& word : read) {
    if (!word->ok()) return word->error();
    words.push_back(word->value());
  }
  return words;
}

/// Symmetric, by rows.
std::vector<std::vector<double>> CompareAll(const std::vector<OutlineWord>& words, bool tells_mirrored) {
  std::vector<std::vector<double>> distances(words.size(), std::vector<double>(words.size()));
  ForEachIndex(words.size(), [&](std::size_t i) {
    const OutlineWord mirrored = Mirror(words[i]);
    for (std::size_t j = 0; j < i; ++j) {
      double distance = WordDistance(words[i], words[j]);
      if (!tells_mirrored) distance = std::min(distance, WordDistance(mirrored, words[j]));
      distances[i][j] = distances[j][i] = distance;
    }
  });
  return distances;
}

std::string Quote(const std::string& field) {
  if (field.find_first_of(",\"\r\n") == std::string::npos) return field;
  std::string quoted = "\"";
  for (const char c : field) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + '"';
}

std::string ToCsv(const std::vector<fs::path>& files, const std::vector<std::vector<double>>& distances) {
  std::ostringstream csv;
  for (const fs::path& file : files) csv << ',' << Quote(file.filename().string());
  csv << '\n';
  for (std::size_t i = 0; i < files.size(); ++i) {
    csv << Quote(files[i].filename().string());
    for (const double distance : distances[i]) csv << ',' << distance;
    csv << '\n';
  }
  return csv.str();
}

Status RunCompare(const CompareArguments& arguments) {
  const Result<std::vector<fs::path>> files = ListFiles(arguments.folder);
  if (!files.ok()) return files.error();
  const Result<std::vector<OutlineWord>> words = ReadWords(files.value());
  if (!words.ok()) return words.error();
  const Status written =
      WriteFile(arguments.out, ToCsv(files.value(), CompareAll(words.value(), arguments.tells_mirrored)));
  if (written.ok()) std::cout << files.value().size() << " shapes compared\n";
  return written;
}

}  // namespace

void AddCompareCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "compare", "Writes how different the shapes of a folder's bitmaps are, each to each, as a table");
  const auto arguments = std::make_shared<CompareArguments>();
  command->add_option("folder", arguments->folder, "One silhouette a file, dark on bright or bright on dark")
      ->required();
  command->add_option("--out", arguments->out, "CSV file: the first row and column are the file names")
      ->required();
  command->add_flag("--tell-mirrored", arguments->tells_mirrored,
                    "Mirror images are other shapes (otherwise a shape and its mirror image are alike)");
  command->callback([arguments] {
    const Status status = RunCompare(*arguments);
    if (status.ok()) return;
    std::cerr << "soffit compare: " << status.error().message << '\n';
    throw CLI::RuntimeError(1);
  });
}

}  // namespace soffit
