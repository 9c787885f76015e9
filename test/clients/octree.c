#include "octree.h"

#include <string.h>

enum { kDepth = 16 };

typedef struct {
  const uint8_t* data;
  size_t size;
  size_t at;
  double resolution_m;
  OctreeVisitor visit;
  void* context;
} Reading;

static void Visit(const Reading* r, const uint32_t key[3], int depth, bool is_occupied) {
  const uint32_t edge = 1U << (kDepth - depth);
  OctreeLeaf leaf;
  for (int axis = 0; axis < 3; ++axis) leaf.low_m[axis] = ((double)key[axis] - (1 << (kDepth - 1))) * r->resolution_m;
  leaf.size_m = edge * r->resolution_m;
  leaf.cells = (uint64_t)edge * edge * edge;
  leaf.is_occupied = is_occupied;
  r->visit(&leaf, r->context);
}

static void KeyOfChild(const uint32_t key[3], int depth, unsigned child, uint32_t child_key[3]) {
  const uint32_t half = 1U << (kDepth - depth - 1);
  for (unsigned axis = 0; axis < 3; ++axis) child_key[axis] = key[axis] + ((child >> axis & 1U) != 0 ? half : 0U);
}

static bool ReadBinaryNode(Reading* r, const uint32_t key[3], int depth) {
  if (depth >= kDepth || r->size - r->at < 2) return false;
  const unsigned bits = (unsigned)r->data[r->at] | (unsigned)r->data[r->at + 1] << 8U;
  r->at += 2;
  for (unsigned child = 0; child < 8; ++child) {
    const unsigned kind = bits >> (2 * child) & 3U; /* 0 unknown, 1 free, 2 occupied, 3 has children. */
    uint32_t child_key[3];
    KeyOfChild(key, depth, child, child_key);
    if (kind == 1 || kind == 2) Visit(r, child_key, depth + 1, kind == 2);
    if (kind == 3 && !ReadBinaryNode(r, child_key, depth + 1)) return false;
  }
  return true;
}

static bool ReadFullNode(Reading* r, const uint32_t key[3], int depth) {
  float log_odds;
  if (depth > kDepth || r->size - r->at < sizeof log_odds + 1) return false;
  memcpy(&log_odds, r->data + r->at, sizeof log_odds);
  const unsigned children = r->data[r->at + sizeof log_odds];
  r->at += sizeof log_odds + 1;
  if (children == 0) Visit(r, key, depth, log_odds >= 0.0F);
  for (unsigned child = 0; child < 8; ++child) {
    if ((children >> child & 1U) == 0) continue;
    uint32_t child_key[3];
    if (depth >= kDepth) return false;
    KeyOfChild(key, depth, child, child_key);
    if (!ReadFullNode(r, child_key, depth + 1)) return false;
  }
  return true;
}

typedef bool (*NodeReader)(Reading* r, const uint32_t key[3], int depth);

static bool ReadTree(NodeReader read, const uint8_t* data, size_t size, double resolution_m, OctreeVisitor visit,
                     void* context) {
  Reading r = {data, size, 0, resolution_m, visit, context};
  const uint32_t root[3] = {0, 0, 0};
  return size == 0 || (read(&r, root, 0) && r.at == size);
}

bool ReadBinaryOctree(const uint8_t* data, size_t size, double resolution_m, OctreeVisitor visit, void* context) {
  return ReadTree(ReadBinaryNode, data, size, resolution_m, visit, context);
}

bool ReadFullOctree(const uint8_t* data, size_t size, double resolution_m, OctreeVisitor visit, void* context) {
  return ReadTree(ReadFullNode, data, size, resolution_m, visit, context);
}
