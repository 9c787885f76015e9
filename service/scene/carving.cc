#include "service/scene/carving.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/result/result.h"

namespace soffit {
namespace {

constexpr double kOtherDirection = 0.985;      // Cosine (10 degrees).
constexpr double kVeryOtherDirection = 0.766;  // Cosine (40 degrees).
constexpr int kBlock = 32;                     // Edge of the largest blocks, in voxels.
constexpr std::uint64_t kAll = ~std::uint64_t{0};

/// Radius of the ball about a cube.
double Reach(double edge_m) { return 0.5 * std::sqrt(3.0) * edge_m; }

/// From the middle of a cube to that of one of its eight parts, over its edge.
Eigen::Vector3d ToPart(int part) {
  return Eigen::Vector3d(part % 2 - 0.5, part / 2 % 2 - 0.5, part / 4 - 0.5) * 0.5;
}

}  // namespace

Carving::Carving(Voxels voxels) : voxels_(std::move(voxels)), proofs_(voxels_.states.size()) {}

bool Carving::Parts::AreFree() const {
  return (sure | likely | (perhaps & perhaps_besides & ~things)) == kAll;
}

void Carving::Add(const Evidence& picture) {
  SOFFIT_EXPECT(cameras_in_map_m_.size() + 1 < std::numeric_limits<std::uint16_t>::max());
  cameras_in_map_m_.push_back(picture.camera_in_map_m());
  capture_ids_.push_back(picture.capture_id());
  const Grid& grid = voxels_.grid;
  for (int x = 0; x < grid.count[0]; x += kBlock) {
    for (int y = 0; y < grid.count[1]; y += kBlock) {
      for (int z = 0; z < grid.count[2]; z += kBlock) AddTo(Block{{x, y, z}, kBlock}, picture);
    }
  }
}

/// Most blocks are told at a glance: the fewer voxels are looked at one by one, the faster.
void Carving::AddTo(const Block& block, const Evidence& picture) {
  if (!voxels_.Has(block.first)) return;
  const auto [x, y, z] = block.first;
  const Grid& grid = voxels_.grid;
  if (block.edge == 1) {
    const std::size_t number = grid.Number(x, y, z);
    if (voxels_.states[number] != Voxel::kSolid) AddTo(number, picture, grid.Center(x, y, z));
    return;
  }
  const int half = block.edge / 2;
  const Eigen::Vector3d middle = grid.Center(x, y, z).array() + (half - 0.5) * grid.voxel_m;
  const auto sees = picture.SeesAlike(middle, Reach(block.edge * grid.voxel_m));
  if (sees) return Mark(block, *sees, picture.MayShowLines());
  for (int part = 0; part < 8; ++part)
    AddTo(Block{{x + part % 2 * half, y + part / 2 % 2 * half, z + part / 4 * half}, half}, picture);
}

void Carving::Mark(const Block& block, Evidence::Sees sees, bool may_show_lines) {
  if (sees == Evidence::Sees::kNothing) return;
  const Grid& grid = voxels_.grid;
  Index end;
  for (std::size_t axis = 0; axis < 3; ++axis)
    end[axis] = std::min(block.first[axis] + block.edge, grid.count[axis]);
  for (int x = block.first[0]; x < end[0]; ++x) {
    for (int y = block.first[1]; y < end[1]; ++y) {
      Proof* proof = &proofs_[grid.Number(x, y, block.first[2])];
      for (int z = block.first[2]; z < end[2]; ++z, ++proof) {
        proof->is_likely_free = true;
        if (may_show_lines) proof->has_no_trace = true;
        if (sees == Evidence::Sees::kSure) proof->is_surely_free = true;
      }
    }
  }
}

void Carving::AddTo(std::size_t number, const Evidence& picture, const Eigen::Vector3d& center) {
  using Sees = Evidence::Sees;
  Proof& proof = proofs_[number];
  const double reach_m = Reach(voxels_.grid.voxel_m);
  if (picture.ShowsBarWithin(center, reach_m)) proof.has_bar = true;
  if (proof.is_surely_free && proof.has_no_trace && !proof.has_bar) return;
  if (picture.ShowsLineWithin(center, reach_m)) proof.has_line = true;
  const Sees sees = picture.SeeThrough(center, reach_m);
  if (sees == Sees::kSure) proof.is_surely_free = true;
  if (sees == Sees::kSure || sees == Sees::kLikely) {
    proof.is_likely_free = true;
    if (picture.MayShowLines() && !picture.ShowsTraceWithin(center, reach_m)) proof.has_no_trace = true;
  }
  if (sees == Sees::kNothing && picture.DistrustsColorAt(center)) proof.is_disputed = true;
  if (sees == Sees::kNothing && picture.ShowsThingAt(center)) {
    proof.shows_things = true;
    Widen(things_[number], center);
  }
  if ((!proof.is_likely_free || proof.is_disputed) && picture.SeesPartly(center, reach_m)) {
    proof.has_parts = true;
    AddParts(parts_[number], picture, center);
  }
}

void Carving::AddParts(Parts& parts, const Evidence& picture, const Eigen::Vector3d& center) const {
  using Sees = Evidence::Sees;
  const double edge_m = voxels_.grid.voxel_m;
  const auto note = [&](Sees sees, std::uint64_t which) {
    if (sees == Sees::kSure) parts.sure |= which;
    if (sees == Sees::kLikely) parts.likely |= which;
    if (sees == Sees::kPerhaps) {
      if (parts.first == 0) parts.first = last();
      const bool is_besides = Cosine(parts.first, last(), center) < kVeryOtherDirection;
      (is_besides ? parts.perhaps_besides : parts.perhaps) |= which;
    }
  };
  for (int part = 0; part < 8; ++part) {
    const Eigen::Vector3d middle = center + edge_m * ToPart(part);
    const double reach_m = Reach(edge_m / 2.0);
    const std::uint64_t which = std::uint64_t{0xFF} << 8 * part;
    const Sees sees = picture.SeeThrough(middle, reach_m);
    note(sees, which);
    if (sees == Sees::kNothing && picture.ShowsThingAt(middle)) parts.things |= which;
    if (sees != Sees::kNothing || !picture.SeesPartly(middle, reach_m)) continue;
    for (int finer = 0; finer < 8; ++finer) {
      const Eigen::Vector3d place = middle + edge_m / 2.0 * ToPart(finer);
      note(picture.SeeThrough(place, reach_m / 2.0), std::uint64_t{1} << (8 * part + finer));
    }
  }
}

Voxels Carving::Judge() const {
  Voxels judged = voxels_;
  ForEach(judged.grid, [&](const Index& at) {
    Voxel& state = judged.At(at);
    if (state != Voxel::kSolid)
      state = Judge(judged.grid.Number(at[0], at[1], at[2]), judged.grid.Center(at[0], at[1], at[2]));
  });
  return judged;
}

Voxel Carving::Judge(std::size_t number, const Eigen::Vector3d& center) const {
  const Proof& proof = proofs_[number];
  const bool may_hide = proof.has_bar || (proof.has_line && !proof.has_no_trace);
  if (proof.is_surely_free && !may_hide) return Voxel::kFree;
  const Parts parts = proof.has_parts ? parts_.at(number) : Parts{};
  if (parts.sure == kAll && !may_hide) return Voxel::kFree;
  if (proof.shows_things && Cosine(things_.at(number), center) < kOtherDirection) return Voxel::kThing;
  if (may_hide) return Voxel::kLine;
  if (proof.is_disputed) return Voxel::kUnknown;
  return proof.is_likely_free || parts.AreFree() ? Voxel::kFree : Voxel::kUnknown;
}

std::vector<std::uint32_t> Carving::CapturesOfThingAt(const Index& at) const {
  std::vector<std::uint32_t> captures;
  const auto things = things_.find(voxels_.grid.Number(at[0], at[1], at[2]));
  if (things == things_.end()) return captures;
  for (const std::uint16_t number : {things->second.first, things->second.second}) {
    if (number > 0) captures.push_back(capture_ids_[number - 1U]);
  }
  return captures;
}

/// Takes the last picture in when that makes the pair's directions differ more.
void Carving::Widen(Pair& pair, const Eigen::Vector3d& place) const {
  const auto last = static_cast<std::uint16_t>(cameras_in_map_m_.size());
  if (pair.first == 0) {
    pair.first = last;
    return;
  }
  const double with_first = Cosine(pair.first, last, place);
  if (pair.second == 0) {
    pair.second = last;
    return;
  }
  const double with_second = Cosine(pair.second, last, place);
  if (std::min(with_first, with_second) >= Cosine(pair, place)) return;
  (with_first < with_second ? pair.second : pair.first) = last;
}

double Carving::Cosine(std::uint16_t a, std::uint16_t b, const Eigen::Vector3d& place) const {
  return (cameras_in_map_m_[a - 1U] - place)
      .normalized()
      .dot((cameras_in_map_m_[b - 1U] - place).normalized());
}

/// Between the directions of the pair; 1 when it has less than two.
double Carving::Cosine(const Pair& pair, const Eigen::Vector3d& place) const {
  return pair.second == 0 ? 1.0 : Cosine(pair.first, pair.second, place);
}

}  // namespace soffit
