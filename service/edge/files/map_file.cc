#include "service/edge/files/map_file.h"

#include <openssl/sha.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <iomanip>
#include <limits>
#include <locale>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <string_view>

#include "service/edge/files/file.h"
#include "shared/result/say.h"

namespace soffit {
namespace fs = std::filesystem;
namespace {

constexpr char kManifestFormat[] = "soffit-map/1";
constexpr char kFrame[] = "map";
constexpr std::uintmax_t kMaxBytes = 1U << 30U;
constexpr std::uintmax_t kMaxManifestBytes = 64U << 10U;
constexpr std::size_t kMaxHeaderBytes = 4096;
constexpr int kDepth = 16;
constexpr std::string_view kBinaryHeader = "# Octomap OcTree binary file";
constexpr std::string_view kFullHeader = "# Octomap OcTree file";

struct Header {
  MapFormat format = MapFormat::kBinary;
  std::optional<std::uint64_t> nodes;
  double resolution_m = 0.0;
};

/// The bytes of a file, taken from the front.
class Cursor {
 public:
  explicit Cursor(std::span<const std::uint8_t> bytes) : rest_(bytes) {}

  bool Has(std::size_t count) const { return rest_.size() >= count; }
  std::uint8_t Byte() {
    const std::uint8_t byte = rest_.front();
    rest_ = rest_.subspan(1);
    return byte;
  }
  float Float() {
    float value;
    std::memcpy(&value, rest_.data(), sizeof(value));
    rest_ = rest_.subspan(sizeof(value));
    return value;
  }
  /// Up to the next line feed; none when there is none near.
  std::optional<std::string> Line() {
    const std::size_t near = std::min(rest_.size(), kMaxHeaderBytes);
    const auto end = std::find(rest_.begin(), rest_.begin() + static_cast<std::ptrdiff_t>(near), '\n');
    if (end == rest_.begin() + static_cast<std::ptrdiff_t>(near)) return std::nullopt;
    std::string line(rest_.begin(), end);
    rest_ = rest_.subspan(line.size() + 1);
    return line;
  }
  std::span<const std::uint8_t> rest() const { return rest_; }

 private:
  std::span<const std::uint8_t> rest_;
};

/// Walks through a tree's bytes as OctoMap's reader would, and counts.
class Walk {
 public:
  Walk(Cursor& cursor, MapFormat format) : cursor_(cursor), format_(format) {}

  /// What is wrong; empty: nothing.
  std::string Check(std::uint64_t nodes) {
    const std::string problem = nodes > 0 ? Node(0) : "";
    if (!problem.empty()) return problem;
    if (!cursor_.rest().empty()) return Say(cursor_.rest().size(), " bytes follow the last node");
    if (nodes_ != nodes) return Say("it has ", nodes_, " nodes, its header says ", nodes);
    return "";
  }

 private:
  std::string Node(int depth) {
    if (depth > kDepth) return Say("it is deeper than ", kDepth, " levels");
    if (++nodes_ > kMaxMapNodes) return Say("it has more than ", kMaxMapNodes, " nodes");
    return format_ == MapFormat::kBinary ? BinaryNode(depth) : FullNode(depth);
  }

  /// Two bits for each child: none, occupied leaf, free leaf, inner node.
  std::string BinaryNode(int depth) {
    if (!cursor_.Has(2)) return "it ends too early";
    const int low = cursor_.Byte();
    const int children = low | (cursor_.Byte() << 8);
    if (children == 0 && depth > 0) return "it has an inner node without children";
    for (int child = 0; child < 8; ++child) {
      const int kind = (children >> (2 * child)) & 3;
      if (kind == 0) continue;
      if (kind == 3) {
        if (const std::string problem = Node(depth + 1); !problem.empty()) return problem;
      } else {
        if (depth == kDepth) return Say("it is deeper than ", kDepth, " levels");
        ++nodes_;
      }
    }
    return "";
  }

  /// Its value, and a bit for each child.
  std::string FullNode(int depth) {
    if (!cursor_.Has(sizeof(float) + 1)) return "it ends too early";
    if (!std::isfinite(cursor_.Float())) return "it has a value that is no number";
    const int children = cursor_.Byte();
    for (int child = 0; child < 8; ++child) {
      if (((children >> child) & 1) == 0) continue;
      if (const std::string problem = Node(depth + 1); !problem.empty()) return problem;
    }
    return "";
  }

  Cursor& cursor_;
  MapFormat format_;
  std::uint64_t nodes_ = 0;
};

template <class T>
std::optional<T> Parse(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  T value{};
  if (!(stream >> value) || stream.peek() != std::istringstream::traits_type::eof()) return std::nullopt;
  return value;
}

Result<Header> ReadHeader(Cursor& cursor) {
  const std::optional<std::string> first = cursor.Line();
  const bool is_binary = first && first->starts_with(kBinaryHeader);
  if (!is_binary && !(first && first->starts_with(kFullHeader))) return InvalidInput("not an OctoMap file");
  Header header;
  header.format = is_binary ? MapFormat::kBinary : MapFormat::kFull;
  bool is_octree = false;
  while (const std::optional<std::string> line = cursor.Line()) {
    if (line->starts_with('#')) continue;
    if (*line == "data") {
      if (!is_octree) return InvalidInput("its tree is not an OcTree");
      if (!header.nodes) return InvalidInput("its header has no size");
      if (!(header.resolution_m > 0.0)) return InvalidInput("its header has no resolution");
      return header;
    }
    const std::size_t space = line->find(' ');
    const std::string key = line->substr(0, space);
    const std::string value = space == std::string::npos ? "" : line->substr(space + 1);
    if (key == "id") is_octree = value == "OcTree";
    if (key == "size") header.nodes = Parse<std::uint64_t>(value);
    if (key == "res") header.resolution_m = Parse<double>(value).value_or(0.0);
  }
  return InvalidInput("its header has no end");
}

std::string Sha256(std::string_view bytes) {
  unsigned char digest[SHA256_DIGEST_LENGTH];
  SHA256(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), digest);
  std::ostringstream text;
  text << std::hex << std::setfill('0');
  for (const unsigned char byte : digest) text << std::setw(2) << static_cast<int>(byte);
  return text.str();
}

fs::path ManifestOf(const fs::path& file) { return file.string() + ".json"; }

const char* ToString(MapFormat format) { return format == MapFormat::kBinary ? "bt" : "ot"; }

Result<MapManifest> ReadManifest(const fs::path& file) {
  const Result<std::vector<std::uint8_t>> text = ReadFile(file, kMaxManifestBytes);
  if (!text.ok()) return text.error();
  const auto json = nlohmann::json::parse(text.value(), nullptr, false);
  try {
    if (json.at("manifest") != kManifestFormat)
      return InvalidInput("manifest: must be " + std::string(kManifestFormat));
    MapManifest manifest;
    const std::string format = json.at("format");
    if (format != "bt" && format != "ot") return InvalidInput("format: must be bt or ot");
    manifest.format = format == "bt" ? MapFormat::kBinary : MapFormat::kFull;
    json.at("sha256").get_to(manifest.sha256);
    json.at("frame").get_to(manifest.frame);
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      json.at("origin").at(static_cast<std::size_t>(axis)).get_to(manifest.origin_m[axis]);
    json.at("scene_revision").get_to(manifest.scene_revision);
    json.at("resolution_m").get_to(manifest.resolution_m);
    json.at("nodes").get_to(manifest.nodes);
    json.at("bytes").get_to(manifest.bytes);
    return manifest;
  } catch (const nlohmann::json::exception& problem) {
    return InvalidInput(Say("not a map's manifest: ", problem.what()));
  }
}

/// What of the manifest is not so; empty: nothing.
std::string FindLie(const MapManifest& manifest, const MapManifest& found) {
  if (manifest.bytes != found.bytes)
    return Say("it has ", found.bytes, " bytes, its manifest says ", manifest.bytes);
  if (manifest.sha256 != found.sha256)
    return "its SHA-256 is not that of its manifest: it was changed or damaged";
  if (manifest.frame != kFrame) return Say("its frame is '", manifest.frame, "', must be '", kFrame, "'");
  if (manifest.format != found.format)
    return Say("it is a .", ToString(found.format), " file, its manifest says otherwise");
  if (manifest.nodes != found.nodes)
    return Say("it has ", found.nodes, " nodes, its manifest says ", manifest.nodes);
  if (manifest.resolution_m != found.resolution_m) return "its resolution is not that of its manifest";
  return "";
}

Result<MapFile> Decode(std::span<const std::uint8_t> bytes) {
  Cursor cursor(bytes);
  const Result<Header> header = ReadHeader(cursor);
  if (!header.ok()) return header.error();
  const auto& [format, nodes, resolution_m] = header.value();
  const std::string_view data(reinterpret_cast<const char*>(cursor.rest().data()), cursor.rest().size());
  const std::string problem = Walk(cursor, format).Check(*nodes);
  if (!problem.empty()) return InvalidInput(problem);

  auto octree = std::make_shared<octomap::OcTree>(resolution_m);
  std::istringstream stream{std::string(data)};
  if (*nodes > 0) format == MapFormat::kBinary ? octree->readBinaryData(stream) : octree->readData(stream);
  return MapFile{octree,
                 {format, "", kFrame, Eigen::Vector3d::Zero(), 0, resolution_m, *nodes, bytes.size()}};
}

}  // namespace

/// OctoMap's own writer reports on standard error.
std::string EncodeMap(const octomap::OcTree& octree, MapFormat format) {
  std::ostringstream stream;
  stream.imbue(std::locale::classic());
  stream << (format == MapFormat::kBinary ? kBinaryHeader : kFullHeader) << "\nid " << octree.getTreeType()
         << "\nsize " << octree.size() << "\nres "
         << std::setprecision(std::numeric_limits<double>::max_digits10) << octree.getResolution()
         << "\ndata\n";
  format == MapFormat::kBinary ? octree.writeBinaryData(stream) : octree.writeData(stream);
  return stream.str();
}

Result<std::shared_ptr<const octomap::OcTree>> DecodeMap(std::span<const std::uint8_t> bytes) {
  Result<MapFile> map = Decode(bytes);
  if (!map.ok()) return map.error();
  return map.value().octree;
}

Status WriteMap(const fs::path& file, const octomap::OcTree& octree, std::uint64_t scene_revision,
                MapFormat format, const Eigen::Vector3d& origin_m) {
  const std::string bytes = EncodeMap(octree, format);
  const nlohmann::ordered_json manifest = {{"manifest", kManifestFormat},
                                           {"format", ToString(format)},
                                           {"sha256", Sha256(bytes)},
                                           {"frame", kFrame},
                                           {"origin", {origin_m.x(), origin_m.y(), origin_m.z()}},
                                           {"scene_revision", scene_revision},
                                           {"resolution_m", octree.getResolution()},
                                           {"nodes", octree.size()},
                                           {"bytes", bytes.size()}};
  if (Status status = WriteFile(file, bytes); !status.ok()) return status;
  return WriteFile(ManifestOf(file), manifest.dump(1) + "\n");
}

Result<MapFile> ReadMap(const fs::path& file) {
  const Result<MapManifest> manifest = ReadManifest(ManifestOf(file));
  if (!manifest.ok())
    return Error{manifest.error().code, ManifestOf(file).string() + ": " + manifest.error().message};
  const Result<std::vector<std::uint8_t>> bytes = ReadFile(file, kMaxBytes);
  if (!bytes.ok()) return bytes.error();
  Result<MapFile> map = Decode(bytes.value());
  if (!map.ok()) return Error{map.error().code, file.string() + ": " + map.error().message};
  map.value().manifest.sha256 =
      Sha256({reinterpret_cast<const char*>(bytes.value().data()), bytes.value().size()});
  const std::string lie = FindLie(manifest.value(), map.value().manifest);
  if (!lie.empty()) return InvalidInput(file.string() + ": " + lie);
  map.value().manifest = manifest.value();
  return map;
}

}  // namespace soffit
