#include "service/edge/files/report.h"

#include <algorithm>
#include <numbers>
#include <sstream>

#include "service/clearance/describe.h"
#include "service/edge/drawing/canvas.h"
#include "service/edge/files/file.h"
#include "service/edge/files/pictures.h"

namespace soffit {
namespace {

using Json = nlohmann::json;
using Row = std::vector<std::string>;

constexpr char kStyle[] = R"(
body{font:15px/1.45 system-ui,sans-serif;color:#222;max-width:1180px;margin:1.5em auto;padding:0 1em}
h1{margin:0 0 .2em} h2{margin:1.4em 0 .4em;border-bottom:1px solid #ccc;font-size:1.15em}
table{border-collapse:collapse;margin:.4em 0} td,th{border:1px solid #ccc;padding:.2em .6em;text-align:left;vertical-align:top}
th{background:#f3f3f3} img{max-width:100%;border:1px solid #ccc}
.pair{display:grid;grid-template-columns:1fr 1fr;gap:1em} .grid{display:grid;grid-template-columns:repeat(3,1fr);gap:.8em}
.verdict{display:inline-block;padding:.1em .6em;border-radius:.3em;color:#fff;font-weight:600}
.CLEAR{background:#0072b2} .BLOCKED{background:#d55e00} .INSUFFICIENT_DATA{background:#777}
figure{margin:0} figcaption{font-size:.85em;color:#555} @media print{body{margin:0;font-size:11px}}
)";

std::string Escape(const std::string& text) {
  std::string safe;
  for (const char c : text) {
    switch (c) {
      case '&':
        safe += "&amp;";
        break;
      case '<':
        safe += "&lt;";
        break;
      case '>':
        safe += "&gt;";
        break;
      case '"':
        safe += "&quot;";
        break;
      default:
        safe += c;
    }
  }
  return safe;
}

std::string Table(const Row& header, const std::vector<Row>& rows) {
  std::string html = "<table>";
  const auto add = [&html](const Row& row, const char* tag) {
    html += "<tr>";
    for (const std::string& cell : row) html += std::string("<") + tag + ">" + cell + "</" + tag + ">";
    html += "</tr>\n";
  };
  if (!header.empty()) add(header, "th");
  for (const Row& row : rows) add(row, "td");
  return html + "</table>\n";
}

std::string Figure(const std::string& file, const std::string& caption) {
  return "<figure><a href=\"" + Escape(file) + "\"><img src=\"" + Escape(file) + "\" alt=\"" +
         Escape(caption) + "\"></a><figcaption>" + Escape(caption) + "</figcaption></figure>\n";
}

std::string Badge(Verdict verdict) {
  const std::string name = ToString(verdict);
  return "<span class=\"verdict " + name + "\">" + name + "</span>";
}

bool IsListOfObjects(const Json& json) {
  return json.is_array() && !json.empty() &&
         std::all_of(json.begin(), json.end(), [](const Json& entry) { return entry.is_object(); });
}

/// Long lists belong to result.json, not onto a page.
std::string ToCell(const Json& value) {
  constexpr std::size_t kLongest = 160;
  if (value.is_number_float()) return FormatNumber(value.get<double>(), 3);
  const std::string text = value.is_string() ? value.get<std::string>() : value.dump();
  return Escape(text.size() > kLongest ? text.substr(0, kLongest) + " ..." : text);
}

/// Any JSON object as a table of names and values; lists of objects become tables of their own below it.
std::string JsonTables(const Json& json) {
  std::vector<Row> rows;
  std::string lists;
  for (const auto& [name, value] : json.items()) {
    if (!IsListOfObjects(value)) {
      rows.push_back({Escape(name), ToCell(value)});
      continue;
    }
    Row header;
    for (const Json& entry : value) {
      for (const auto& [key, ignored] : entry.items()) {
        if (std::find(header.begin(), header.end(), key) == header.end()) header.push_back(key);
      }
    }
    std::vector<Row> list;
    for (const Json& entry : value) {
      Row row;
      for (const std::string& key : header) row.push_back(entry.contains(key) ? ToCell(entry[key]) : "");
      list.push_back(row);
    }
    for (std::string& key : header) key = Escape(key);
    lists += "<p>" + Escape(name) + "</p>" + Table(header, list);
  }
  return Table({}, rows) + lists;
}

std::string Decisions(const Understanding& all) {
  std::vector<Row> rows;
  for (const ClearanceDecision& decision : all.decisions) {
    std::string pictures;
    for (const std::uint32_t capture : decision.evidence)
      pictures += (pictures.empty() ? "" : ", ") + std::to_string(capture);
    rows.push_back({std::to_string(decision.object_id),
                    decision.side < 0 ? "all" : std::to_string(decision.side), Badge(decision.verdict),
                    Escape(decision.reason), Escape(DescribeRoom(decision)), pictures});
  }
  if (rows.empty()) return "<p>No decision was made.</p>\n";
  return Table({"building", "side", "decision", "reason", "room", "pictures"}, rows);
}

std::string Buildings(const Scene& scene) {
  std::vector<Row> rows;
  for (const SceneObject& object : scene.objects) {
    const Footprint& footprint = object.footprint;
    Row row = {std::to_string(footprint.object_id),
               Escape(footprint.color),
               std::to_string(footprint.polygon_in_map_m.outer.size()),
               footprint.height_m > 0.0 ? FormatNumber(footprint.height_m, 2) + " &plusmn; " +
                                              FormatNumber(footprint.height_std_m, 2)
                                        : "not known",
               object.is_matched ? "wanted" : "",
               "",
               ""};
    if (object.is_matched) {
      row[5] = FormatNumber(object.match.score, 3) + "; " +
               FormatNumber(object.match.rotation_cw_rad * 180.0 / std::numbers::pi, 1) + " deg clockwise; " +
               FormatNumber(object.match.scale, 4) + " m per pixel";
    }
    for (const Solid& solid : scene.solids) {
      if (solid.footprint.object_id != footprint.object_id) continue;
      const std::string id = std::to_string(footprint.object_id);
      row[6] = "<a href=\"models/" + id + ".obj\">model</a>, " + FormatNumber(solid.volume_m3, 2) +
               " m<sup>3</sup>, " + std::to_string(solid.openings.size()) + " openings";
    }
    rows.push_back(row);
  }
  return Table({"building", "colour", "corners", "height [m]", "", "match: score, rotation, scale", "model"},
               rows);
}

}  // namespace

Status WriteReport(const std::filesystem::path& folder, const Understanding& understanding,
                   const std::vector<Observation>& observations, const FlightRecord& flight,
                   const std::string& reference_file) {
  std::ostringstream html;
  html << "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>Soffit "
          "report</title><style>"
       << kStyle << "</style></head><body>\n<h1>Soffit report</h1>\n";
  if (flight.mission.contains("outcome"))
    html << "<p>Mission: <b>" << ToCell(flight.mission["outcome"]) << "</b></p>\n";
  for (const ClearanceDecision& decision : understanding.decisions) {
    html << "<p>" << Badge(decision.verdict) << " " << Escape(Describe(decision)) << "</p>\n";
  }
  for (const std::string& problem : understanding.problems) html << "<p>" << Escape(problem) << "</p>\n";

  if (!observations.empty()) {
    html << "<div class=\"pair\">" << Figure("scene.png", "The enriched scene")
         << Figure("top_view.png", "From above") << "</div>\n";
  }
  html << "<h2>Decisions</h2>\n"
       << Decisions(understanding) << "<h2>Buildings</h2>\n"
       << Buildings(understanding.scene);
  if (!reference_file.empty())
    html << "<div class=\"grid\">" << Figure(reference_file, "What is wanted") << "</div>\n";
  html << "<h2>Pictures</h2>\n<div class=\"grid\">\n";
  for (const Observation& seen : observations) {
    const std::string caption = std::to_string(seen.image.capture_id) + ": " + ToString(seen.image.purpose);
    html << Figure(OverlayFile(seen.image), caption);
  }
  html << "</div>\n<p>As they were taken:";
  for (const Observation& seen : observations) {
    html << " <a href=\"" << Escape(seen.image.name) << "\">" << Escape(seen.image.name) << "</a>";
  }
  html << "</p>\n";
  if (flight.mission.is_object()) html << "<h2>Mission</h2>\n" << JsonTables(flight.mission);
  if (flight.truth.is_object())
    html << "<h2>Ground truth of the simulator</h2>\n" << JsonTables(flight.truth);
  html << "<h2>For other programs</h2>\n<p>";
  for (const char* file : {"result.json", "scene.bt", "scene.city.json", "scene.gpkg", "summary.png"}) {
    if (!std::filesystem::exists(folder / file)) continue;
    html << "<a href=\"" << file << "\">" << file << "</a> ";
  }
  html << "</p>\n</body></html>\n";
  return WriteFile(folder / "report.html", html.str());
}

}  // namespace soffit
