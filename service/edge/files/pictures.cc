#include "service/edge/files/pictures.h"

#include <algorithm>
#include <opencv2/imgcodecs.hpp>

#include "service/edge/drawing/canvas.h"
#include "service/edge/drawing/overlay.h"
#include "service/edge/drawing/scene_picture.h"
#include "service/edge/drawing/top_view.h"
#include "service/edge/files/file.h"

namespace soffit {
namespace fs = std::filesystem;
namespace {

constexpr int kSummaryHeight_px = 720;
const cv::Size kScene_px(1280, 900);

Status WritePicture(const fs::path& file, const cv::Mat3b& picture) {
  std::vector<uchar> bytes;
  if (!cv::imencode(file.extension().string(), picture, bytes)) {
    return Error{Error::Code::kInternal, file.string() + ": the picture cannot be encoded"};
  }
  return WriteFile(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// The picture that tells most: of a wall that a decision was made about, else of any wall, else the first
/// one.
std::size_t MostTelling(const Understanding& understanding, const std::vector<Observation>& observations) {
  const auto rank = [&](const Observation& seen) {
    const bool is_evidence = std::any_of(
        understanding.decisions.begin(), understanding.decisions.end(),
        [&](const ClearanceDecision& decision) {
          return std::count(decision.evidence.begin(), decision.evidence.end(), seen.image.capture_id) > 0;
        });
    return (seen.image.purpose == Purpose::kWall ? 2 : 0) + (is_evidence ? 1 : 0);
  };
  const auto best = std::max_element(observations.begin(), observations.end(),
                                     [&](const auto& a, const auto& b) { return rank(a) < rank(b); });
  return static_cast<std::size_t>(best - observations.begin());
}

}  // namespace

std::string OverlayFile(const Image& image) {
  std::string name = fs::path(image.name).replace_extension(".jpg").string();
  std::replace(name.begin(), name.end(), '/', '_');
  return "overlay/" + name;
}

Status WritePictures(const fs::path& folder, const Understanding& understanding,
                     const std::vector<Observation>& observations, const FlightRecord& flight) {
  SOFFIT_EXPECT(!observations.empty());
  const std::size_t telling = MostTelling(understanding, observations);
  cv::Mat3b shown;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    const Drawing overlay = DrawOverlay(observations[i], understanding);
    if (i == telling) shown = overlay.picture;
    const fs::path file = folder / OverlayFile(observations[i].image);
    if (Status status = WritePicture(file, AddCaption(overlay)); !status.ok()) return status;
  }
  const Drawing map = DrawTopView(understanding, observations, flight.track_in_map_m);
  const Drawing scene = DrawScenePicture(understanding, observations, flight.track_in_map_m, kScene_px);
  if (Status status = WritePicture(folder / "top_view.png", AddCaption(map)); !status.ok()) return status;
  if (Status status = WritePicture(folder / "scene.png", AddCaption(scene)); !status.ok()) return status;
  return WritePicture(folder / "summary.png",
                      PlaceSideBySide({shown, map.picture, scene.picture}, kSummaryHeight_px));
}

}  // namespace soffit
