#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "shared/result/result.h"
#include "test/sim/render/renderer.h"
#include "test/sim/survey/frames.h"

namespace soffit::sim {

/// An offline survey (soffit-survey/1) and its truth. Pictures: the overview, one from above of each wanted
/// building and of one other, and of each wanted building the walls from three or four sides, front and back
/// among them; places that something occupies are left out.
struct Survey {
  Truth truth;
  std::vector<SurveyFrame> frames;
  std::vector<std::vector<std::uint8_t>> jpegs;  ///< One for each frame.
};

/// @param renderer  Of the same world. Same world and seed: same bytes.
Survey RenderSurvey(const World& world, const Renderer& renderer, std::uint64_t seed);

/// Writes pictures, reference.png, survey.json with poses that are wrong by the world's pose noise, and
/// truth.json (soffit-truth/1: objects with footprints, solids and passages, the match, the right decisions).
Status WriteSurvey(const World& world, const Survey& survey, const std::filesystem::path& folder);

/// Renders and writes.
Status WriteSurvey(const World& world, std::uint64_t seed, const std::filesystem::path& folder,
                   int threads = 1);

}  // namespace soffit::sim
