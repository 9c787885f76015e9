#include "service/match/match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <optional>

#include "service/match/similarity.h"
#include "service/match/word.h"

namespace soffit {
namespace {

using Eigen::Vector2d;
using std::numbers::pi;

constexpr std::size_t kSectors = 72;
constexpr double kWordTolerance = 0.06;  ///< Of the square root of the area.
constexpr double kProfileError = 0.006;  ///< Of profile distances, for each perimeter over `side`.
constexpr double kMaxWordCost = 0.35;
constexpr std::size_t kMaxRotations = 8;
constexpr double kSameRotation_rad = 0.12;
constexpr double kTolerance = 0.015;  ///< Misfit of shapes without roughness that may still be the same.
constexpr double kTolerancePerRoughness = 2.2;
constexpr double kMaxTolerance = 0.12;
constexpr double kMaxLoneTolerance = 0.04;   ///< A rougher or smaller shape could be anything, when alone.
constexpr double kPositionTolerance = 0.04;  ///< Of the side of a shape, between the shapes of a group.
constexpr double kTolerancePerPositionStd = 2.0;
constexpr double kScoreAtTolerance = 0.85;
constexpr double kMaxAnchorMisfitRatio = 4.0;
constexpr double kMaxGlanceMisfitRatio = 5.0;  ///< Of a rough fit that could still become a match.
constexpr double kMaxNeighbourOffset = 0.5;    ///< Of the square root of the neighbour's area.
constexpr double kMaxAreaRatio = 1.5;

/// Area by direction from the centroid: invariant to position and scale, a rotation shifts it.
using Profile = std::array<double, kSectors>;

struct Shape {
  const Polygon* polygon = nullptr;
  double roughness = 0.0;     ///< Over `side`.
  double position_std = 0.0;  ///< Over `side`.
  Vector2d centroid = Vector2d::Zero();
  double side = 0.0;       ///< Square root of the area.
  double perimeter = 0.0;  ///< Over `side`, with holes.
  Profile profile{};
};

void AddToProfile(const Ring& ring, const Vector2d& center, double area, Profile& profile) {
  const double step = Perimeter(ring) / (4.0 * kSectors);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vector2d a = ring[i] - center;
    const Vector2d side = ring[(i + 1) % ring.size()] - ring[i];
    const int count = std::max(1, static_cast<int>(std::ceil(side.norm() / step)));
    for (int k = 0; k < count; ++k) {
      const Vector2d p = a + side * (static_cast<double>(k) / count);
      const Vector2d q = a + side * ((k + 1.0) / count);
      const Vector2d middle = 0.5 * (p + q);
      const double sector = (std::atan2(middle.y(), middle.x()) / (2.0 * pi) + 1.0) * kSectors;
      const double triangle = 0.5 * (p.x() * q.y() - p.y() * q.x());
      const double base = std::floor(sector - 0.5);
      const double share = sector - 0.5 - base;  // Of the next sector: linear, so that edges do not jump.
      const auto index = static_cast<std::size_t>(base);
      profile[index % kSectors] += (1.0 - share) * triangle / area;
      profile[(index + 1) % kSectors] += share * triangle / area;
    }
  }
}

Shape Describe(const TracedShape& traced) {
  const Polygon& polygon = traced.polygon;
  Shape shape;
  shape.polygon = &polygon;
  shape.centroid = Centroid(polygon);
  const double area = Area(polygon);
  shape.side = std::sqrt(area);
  shape.roughness = traced.roughness / shape.side;
  shape.position_std = traced.position_std / shape.side;
  const auto add = [&](const Ring& ring) {
    AddToProfile(ring, shape.centroid, area, shape.profile);
    shape.perimeter += Perimeter(ring) / shape.side;
  };
  add(polygon.outer);
  std::for_each(polygon.holes.begin(), polygon.holes.end(), add);
  return shape;
}

Word SpellOuter(const Shape& shape) { return Spell(shape.polygon->outer, kWordTolerance * shape.side); }

bool IsUsable(const TracedShape& shape) {
  const Polygon& polygon = shape.polygon;
  return polygon.outer.size() >= 3 && std::isfinite(Area(polygon)) && Area(polygon) > 0.0;
}

/// Of `a` turned by `shift` sectors from `b`, as a share of the area; between sectors profiles are taken as
/// linear.
double ProfileDistance(const Profile& a, const Profile& b, double shift) {
  const double whole = std::floor(shift);
  const double share = shift - whole;
  const auto first = static_cast<std::size_t>(whole + kSectors) % kSectors;
  double sum = 0.0;
  for (std::size_t i = 0; i < kSectors; ++i) {
    const double between = (1.0 - share) * b[(i + first) % kSectors] + share * b[(i + first + 1) % kSectors];
    sum += std::abs(a[i] - between);
  }
  return 0.5 * sum;
}

struct RotationCandidate {
  double rotation_ccw_rad = 0.0;
  double distance = 0.0;
};

void AddRotation(std::vector<RotationCandidate>& rotations, const RotationCandidate& candidate) {
  for (const RotationCandidate& known : rotations) {
    const double difference = std::remainder(known.rotation_ccw_rad - candidate.rotation_ccw_rad, 2.0 * pi);
    if (std::abs(difference) < kSameRotation_rad) return;
  }
  if (rotations.size() < kMaxRotations) rotations.push_back(candidate);
}

/// The rotations at which the profiles of shapes are nearest, likely ones first. Outlines that lie no farther
/// apart than twice the tolerance bound areas that differ by at most that times the perimeter, and half of
/// the difference is the distance of their profiles. Shapes whose profiles lie farther apart have no such
/// rotation.
std::vector<RotationCandidate> FindRotationsByProfile(const Shape& a, const Shape& b, double tolerance) {
  const double allowed = (kProfileError + tolerance) * std::min(a.perimeter, b.perimeter);
  std::array<double, kSectors> distance;
  for (std::size_t shift = 0; shift < kSectors; ++shift) {
    distance[shift] = ProfileDistance(a.profile, b.profile, static_cast<double>(shift));
  }
  std::vector<RotationCandidate> rotations;
  for (std::size_t i = 0; i < kSectors; ++i) {
    if (distance[i] > distance[(i + 1) % kSectors] || distance[i] > distance[(i + kSectors - 1) % kSectors])
      continue;
    RotationCandidate best{0.0, std::numeric_limits<double>::infinity()};
    for (const double part : {-0.5, -0.25, 0.0, 0.25, 0.5}) {
      const double shift = static_cast<double>(i) + part;
      const double near = ProfileDistance(a.profile, b.profile, shift);
      if (near < best.distance) best = {2.0 * pi * shift / kSectors, near};
    }
    if (best.distance <= allowed) rotations.push_back(best);
  }
  std::stable_sort(
      rotations.begin(), rotations.end(),
      [](const RotationCandidate& x, const RotationCandidate& y) { return x.distance < y.distance; });
  return rotations;
}

/// Rotations by which `a` may lie like `b`, likely ones first: what the words say, then what the profiles
/// say. None when the shapes are too different.
std::vector<double> FindRotations(const Shape& a, const Word& word_of_a, const Shape& b, double tolerance) {
  const std::vector<RotationCandidate> by_profile = FindRotationsByProfile(a, b, tolerance);
  if (by_profile.empty()) return {};
  std::vector<RotationCandidate> rotations;
  for (const WordAlignment& alignment : AlignWords(word_of_a, SpellOuter(b))) {
    if (alignment.cost > kMaxWordCost) break;
    AddRotation(rotations, {alignment.rotation_ccw_rad, alignment.cost});
  }
  for (const RotationCandidate& candidate : by_profile) AddRotation(rotations, candidate);
  std::vector<double> result;
  for (const RotationCandidate& candidate : rotations) result.push_back(candidate.rotation_ccw_rad);
  return result;
}

Similarity LayOn(const Shape& a, const Shape& b, double rotation_ccw_rad) {
  const double scale = b.side / a.side;
  Similarity similarity{scale * std::cos(rotation_ccw_rad), scale * std::sin(rotation_ccw_rad),
                        Vector2d::Zero()};
  similarity.translation = b.centroid - similarity * a.centroid;
  return similarity;
}

/// 1 for shapes that coincide; kScoreAtTolerance for a misfit that shape and roughness just allow.
double ScoreOf(double misfit_ratio) {
  return 1.0 / (1.0 + (1.0 / kScoreAtTolerance - 1.0) * misfit_ratio * misfit_ratio);
}

double MisfitRatioOf(double score) {
  return std::sqrt((1.0 / score - 1.0) / (1.0 / kScoreAtTolerance - 1.0));
}

/// One way to lay the whole reference on shapes of the map.
struct Pose2d {
  std::vector<std::size_t> shapes;
  Similarity similarity;
  double misfit_ratio = std::numeric_limits<double>::infinity();  ///< 1: just allowed.
};

class Matcher {
 public:
  Matcher(const std::vector<TracedShape>& map, const Reference& reference) {
    for (const TracedShape& shape : reference.shapes) reference_.push_back(Describe(shape));
    for (std::size_t i = 0; i < map.size(); ++i) {
      if (!IsUsable(map[i])) continue;
      map_.push_back(Describe(map[i]));
      index_.push_back(i);
    }
  }

  /// Every way to lay the reference on the map that could be right.
  std::vector<Pose2d> FindPoses() const {
    std::vector<Pose2d> poses;
    const std::size_t anchor = ChooseAnchor();
    const Word word = SpellOuter(reference_[anchor]);
    for (std::size_t j = 0; j < map_.size(); ++j) {
      for (const double rotation : FindRotations(reference_[anchor], word, map_[j], ToleranceOf(anchor, j))) {
        if (auto pose = LayReference(anchor, j, rotation)) poses.push_back(std::move(*pose));
      }
    }
    return poses;
  }

  /// Lengths and angles that a shape must share with the reference, at least: of a box only its proportion.
  double CountFreedoms() const {
    std::size_t sides = 0;
    for (const Shape& shape : reference_) sides += SpellOuter(shape).size();
    return std::max(1.0, static_cast<double>(sides) - 3.0);
  }

 private:
  /// The shape of the reference that tells most: large and with many sides.
  std::size_t ChooseAnchor() const {
    std::vector<double> telling;
    for (const Shape& shape : reference_) {
      telling.push_back(shape.side * std::sqrt(static_cast<double>(SpellOuter(shape).size())));
    }
    return static_cast<std::size_t>(std::max_element(telling.begin(), telling.end()) - telling.begin());
  }

  std::optional<Pose2d> LayReference(std::size_t anchor, std::size_t on, double rotation_ccw_rad) const {
    Similarity similarity =
        RefineSimilarity({Pair(anchor, on)}, LayOn(reference_[anchor], map_[on], rotation_ccw_rad), kGlance);
    if (MisfitRatio(anchor, on, similarity, kGlance) > kMaxGlanceMisfitRatio) return std::nullopt;
    similarity = RefineSimilarity({Pair(anchor, on)}, similarity);
    const double misfit_ratio = MisfitRatio(anchor, on, similarity);
    if (reference_.size() == 1) return Pose2d{{index_[on]}, similarity, misfit_ratio};
    if (misfit_ratio > kMaxAnchorMisfitRatio) return std::nullopt;
    std::vector<std::size_t> partners(reference_.size());
    for (std::size_t i = 0; i < reference_.size(); ++i) {
      const auto partner = i == anchor ? std::optional(on) : FindPartner(i, similarity, partners, i);
      if (!partner) return std::nullopt;
      partners[i] = *partner;
    }
    std::vector<ShapePair> pairs;
    for (std::size_t i = 0; i < partners.size(); ++i) pairs.push_back(Pair(i, partners[i]));
    Pose2d pose;
    pose.similarity = RefineSimilarity(pairs, similarity);
    double sum = 0.0;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double ratio = MemberMisfitRatio(i, partners[i], pose.similarity);
      sum += ratio * ratio;
      pose.shapes.push_back(index_[partners[i]]);
    }
    pose.misfit_ratio = std::sqrt(sum / static_cast<double>(pairs.size()));
    return pose;
  }

  /// The shape of the map where shape `i` of the reference should lie.
  std::optional<std::size_t> FindPartner(std::size_t i, const Similarity& similarity,
                                         const std::vector<std::size_t>& partners, std::size_t taken) const {
    const Vector2d expected = similarity * reference_[i].centroid;
    const double side = similarity.Scale() * reference_[i].side;
    std::optional<std::size_t> best;
    double nearest = kMaxNeighbourOffset * side;
    for (std::size_t j = 0; j < map_.size(); ++j) {
      const double ratio = map_[j].side * map_[j].side / (side * side);
      const double distance = (map_[j].centroid - expected).norm();
      const bool is_taken = std::find(partners.begin(), partners.begin() + static_cast<std::ptrdiff_t>(taken),
                                      j) != partners.begin() + static_cast<std::ptrdiff_t>(taken);
      if (is_taken || ratio > kMaxAreaRatio || ratio < 1.0 / kMaxAreaRatio || distance >= nearest) continue;
      nearest = distance;
      best = j;
    }
    return best;
  }

  /// Misfit of equal shapes that are drawn as roughly as these.
  double ToleranceOf(std::size_t i, std::size_t j) const {
    const double roughness = std::hypot(reference_[i].roughness, map_[j].roughness);
    return std::min(reference_.size() == 1 ? kMaxLoneTolerance : kMaxTolerance,
                    std::hypot(kTolerance, kTolerancePerRoughness * roughness));
  }

  /// How far apart the outlines lie, over how far apart those of equal shapes may lie.
  double MisfitRatio(std::size_t i, std::size_t j, const Similarity& similarity,
                     const Effort& effort = {}) const {
    return Misfit(Pair(i, j), similarity, effort) / ToleranceOf(i, j);
  }

  /// Of one shape of a group: its own misfit in the place where it lies, and how far beside the common one
  /// that is.
  double MemberMisfitRatio(std::size_t i, std::size_t j, Similarity similarity) const {
    const Vector2d offset = map_[j].centroid - similarity * reference_[i].centroid;
    similarity.translation += offset;
    const double position_std = std::hypot(reference_[i].position_std, map_[j].position_std);
    const double allowed =
        map_[j].side * std::hypot(kPositionTolerance, kTolerancePerPositionStd * position_std);
    return std::max(MisfitRatio(i, j, similarity), offset.norm() / allowed);
  }

  ShapePair Pair(std::size_t i, std::size_t j) const { return {reference_[i].polygon, map_[j].polygon}; }

  std::vector<Shape> reference_;
  std::vector<Shape> map_;
  std::vector<std::size_t> index_;  ///< Of `map_` in the caller's map.
};

double Clockwise(double rotation_ccw_rad) {
  const double angle = std::fmod(-rotation_ccw_rad, 2.0 * pi);
  return angle < 0.0 ? angle + 2.0 * pi : angle;
}

/// All poses on the same shapes as one match: the best, with the rotations that fit as well.
Match Summarize(std::vector<Pose2d> poses, const MatchOptions& options) {
  std::stable_sort(poses.begin(), poses.end(),
                   [](const Pose2d& a, const Pose2d& b) { return a.misfit_ratio < b.misfit_ratio; });
  const Pose2d& best = poses.front();
  Match match;
  match.shapes = best.shapes;
  match.scale = best.similarity.Scale();
  match.rotation_cw_rad = Clockwise(best.similarity.RotationCcw_rad());
  match.translation = best.similarity.translation;
  match.score = ScoreOf(best.misfit_ratio);
  for (const Pose2d& pose : poses) {
    const double rotation = Clockwise(pose.similarity.RotationCcw_rad());
    const bool is_known =
        std::any_of(match.equivalent_rotations_cw_rad.begin(), match.equivalent_rotations_cw_rad.end(),
                    [&](double known) {
                      return std::abs(std::remainder(known - rotation, 2.0 * pi)) < kSameRotation_rad;
                    });
    if (!is_known && ScoreOf(pose.misfit_ratio) >= match.score - options.symmetry_margin) {
      match.equivalent_rotations_cw_rad.push_back(rotation);
    }
  }
  return match;
}

/// How many places would pass for the best one by chance. When `freedoms` lengths of shapes scatter evenly as
/// far as the place that is r times as far off as a match may be, r^-freedoms of those that scatter so are
/// matches (A. Desolneux, L. Moisan and J.-M. Morel, "Meaningful alignments", IJCV 40(1), 2000).
double ExpectRivals(const std::vector<Match>& places, double freedoms, const MatchOptions& options) {
  double rivals = 0.0;
  for (std::size_t i = 1; i < places.size(); ++i) {
    const double ratio = MisfitRatioOf(options.min_score) / MisfitRatioOf(places[i].score);
    rivals += std::pow(std::min(1.0, ratio), freedoms);
  }
  return rivals;
}

}  // namespace

std::vector<Match> FindMatches(const std::vector<TracedShape>& map, const Reference& reference,
                               const MatchOptions& options) {
  SOFFIT_EXPECT(IsValidOptions(options));
  SOFFIT_EXPECT(!reference.shapes.empty());
  SOFFIT_EXPECT(std::all_of(reference.shapes.begin(), reference.shapes.end(), IsUsable));
  const Matcher matcher(map, reference);
  std::map<std::vector<std::size_t>, std::vector<Pose2d>> poses_on;  // By the shapes, in whatever order.
  for (Pose2d& pose : matcher.FindPoses()) {
    std::vector<std::size_t> place = pose.shapes;
    std::sort(place.begin(), place.end());
    poses_on[place].push_back(std::move(pose));
  }
  std::vector<Match> places;
  for (auto& [place, poses] : poses_on) places.push_back(Summarize(std::move(poses), options));
  std::stable_sort(places.begin(), places.end(),
                   [](const Match& a, const Match& b) { return a.score > b.score; });
  std::vector<Match> matches = places;
  std::erase_if(matches, [&](const Match& match) { return match.score < options.min_score; });
  const bool is_ambiguous = ExpectRivals(places, matcher.CountFreedoms(), options) > options.max_rivals;
  for (Match& match : matches) match.is_ambiguous = is_ambiguous;
  return matches;
}

}  // namespace soffit
