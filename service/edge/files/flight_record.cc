#include "service/edge/files/flight_record.h"

#include <array>
#include <cmath>
#include <sstream>

#include "service/edge/files/file.h"

namespace soffit {
namespace fs = std::filesystem;
namespace {

constexpr std::uintmax_t kMaxBytes = 256U << 20U;
constexpr std::array<const char*, 3> kColumns = {"x_m", "y_m", "z_m"};

std::vector<std::string> SplitCells(const std::string& line) {
  std::vector<std::string> cells;
  std::istringstream stream(line);
  for (std::string cell; std::getline(stream, cell, ',');) {
    while (!cell.empty() && (cell.back() == '\r' || cell.back() == ' ')) cell.pop_back();
    cells.push_back(cell);
  }
  return cells;
}

std::optional<double> ToNumber(const std::string& cell) {
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  if (cell.empty() || *end != '\0' || !std::isfinite(value)) return std::nullopt;
  return value;
}

}  // namespace

Result<nlohmann::json> ReadJsonFile(const fs::path& file) {
  const Result<std::vector<std::uint8_t>> text = ReadFile(file, kMaxBytes);
  if (!text.ok()) return text.error();
  nlohmann::json json = nlohmann::json::parse(text.value(), nullptr, false);
  if (!json.is_object()) return InvalidInput(file.string() + ": not a JSON object");
  return json;
}

Result<std::vector<Eigen::Vector3d>> ReadTrackFile(const fs::path& file) {
  const Result<std::vector<std::uint8_t>> text = ReadFile(file, kMaxBytes);
  if (!text.ok()) return text.error();
  std::istringstream lines(std::string(text.value().begin(), text.value().end()));
  std::string line;
  std::getline(lines, line);
  const std::vector<std::string> header = SplitCells(line);
  std::array<std::size_t, 3> columns{};
  for (std::size_t i = 0; i < 3; ++i) {
    columns[i] =
        static_cast<std::size_t>(std::find(header.begin(), header.end(), kColumns[i]) - header.begin());
    if (columns[i] == header.size())
      return InvalidInput(file.string() + ": line 1: no column " + kColumns[i]);
  }
  std::vector<Eigen::Vector3d> track;
  for (int number = 2; std::getline(lines, line); ++number) {
    if (line.empty()) continue;
    const std::vector<std::string> cells = SplitCells(line);
    Eigen::Vector3d point;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::optional<double> value =
          columns[i] < cells.size() ? ToNumber(cells[columns[i]]) : std::nullopt;
      if (!value) {
        return InvalidInput(file.string() + ": line " + std::to_string(number) + ": " + kColumns[i] +
                            " is no number");
      }
      point[static_cast<Eigen::Index>(i)] = *value;
    }
    track.push_back(point);
  }
  return track;
}

}  // namespace soffit
