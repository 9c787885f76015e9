#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>

#include "service/edge/cli/commands.h"
#include "service/edge/files/bitmap.h"
#include "service/edge/files/file.h"
#include "service/match/match.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr double kMinShapeArea_px = 60.0;

struct RecognizeArguments {
  fs::path small;
  fs::path big;
  fs::path out;
  MatchOptions match;
};

struct Recognition {
  std::vector<TracedShape> shapes;  ///< Of the big map, y-up.
  std::vector<Match> matches;
};

Result<Recognition> Recognize(const RecognizeArguments& arguments) {
  const Result<cv::Mat1b> small = ReadBitmapFile(arguments.small);
  if (!small.ok()) return small.error();
  const Result<Reference> reference = ReadReference(small.value());
  if (!reference.ok()) return InvalidInput(arguments.small.string() + ": " + reference.error().message);
  const Result<cv::Mat1b> big = ReadBitmapFile(arguments.big);
  if (!big.ok()) return big.error();
  Recognition recognition;
  recognition.shapes = ReadShapes(big.value(), kMinShapeArea_px);
  recognition.matches = FindMatches(recognition.shapes, reference.value(), arguments.match);
  return recognition;
}

double Degrees(double radians) { return radians * 180.0 / std::numbers::pi; }

/// One entry for each shape: those of a group share scale, rotation, score and the number of the match.
Json ToJson(const Recognition& recognition) {
  Json entries = Json::array();
  for (std::size_t i = 0; i < recognition.matches.size(); ++i) {
    const Match& match = recognition.matches[i];
    Json rotations = Json::array();
    for (const double rotation : match.equivalent_rotations_cw_rad) rotations.push_back(Degrees(rotation));
    for (const std::size_t shape : match.shapes) {
      const Eigen::Vector2d centroid = Centroid(recognition.shapes[shape].polygon);
      entries.push_back({{"shape_centroid_px", {centroid.x(), -centroid.y()}},
                         {"scale", match.scale},
                         {"rotation_cw_deg", Degrees(match.rotation_cw_rad)},
                         {"equivalent_rotations_cw_deg", rotations},
                         {"score", match.score},
                         {"ambiguous", match.is_ambiguous},
                         {"match", i}});
    }
  }
  return {{"matches", entries}};
}

[[noreturn]] void Fail(const std::string& message) {
  std::cerr << "soffit recognize: " << message << '\n';
  throw CLI::RuntimeError(1);
}

void RunRecognize(const RecognizeArguments& arguments) {
  const Result<Recognition> recognition = Recognize(arguments);
  if (!recognition.ok()) Fail(recognition.error().message);
  const Status written = WriteFile(arguments.out, ToJson(recognition.value()).dump(1) + "\n");
  if (!written.ok()) Fail(written.error().message);
  std::cout << recognition.value().matches.size() << " matches among " << recognition.value().shapes.size()
            << " shapes\n";
}

}  // namespace

void AddRecognizeCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand("recognize", "Finds the shapes of a small bitmap in a big one");
  const auto arguments = std::make_shared<RecognizeArguments>();
  command->add_option("small", arguments->small, "Black shapes on white: what is wanted")->required();
  command->add_option("big", arguments->big, "Black shapes on white: where to look")->required();
  command->add_option("--out", arguments->out, "JSON file for the matches")->required();
  command->add_option("--min-score", arguments->match.min_score, "Worse matches are none")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  command->callback([arguments] { RunRecognize(*arguments); });
}

}  // namespace soffit
