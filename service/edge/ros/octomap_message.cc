#include "service/edge/ros/octomap_message.h"

#include <sstream>

namespace soffit::ros {
namespace {

Octomap_ MakeOctomap(const octomap::OcTree& octree, std::int64_t stamp_utc_ns, bool is_binary) {
  std::ostringstream data;
  if (is_binary) {
    octree.writeBinaryData(data);
  } else {
    octree.writeData(data);
  }
  const std::string bytes = data.str();
  Octomap_ message;
  message.header_(MakeHeader(stamp_utc_ns, kMapFrame));
  message.binary_(is_binary);
  message.id_(octree.getTreeType());
  message.resolution_(octree.getResolution());
  message.data_().assign(bytes.begin(), bytes.end());
  return message;
}

}  // namespace

Octomap_ MakeBinaryOctomap(const octomap::OcTree& octree, std::int64_t stamp_utc_ns) {
  return MakeOctomap(octree, stamp_utc_ns, true);
}

Octomap_ MakeFullOctomap(const octomap::OcTree& octree, std::int64_t stamp_utc_ns) {
  return MakeOctomap(octree, stamp_utc_ns, false);
}

}  // namespace soffit::ros
