#ifndef SOFFIT_TEST_CLIENTS_OCTREE_H_
#define SOFFIT_TEST_CLIENTS_OCTREE_H_

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Reads the data of octomap_msgs/Octomap without liboctomap (K. Wurm et al., 2010; layout of .bt and .ot files after
   their header). Whatever the bytes are, it reads none beyond them. */

typedef struct {
  double low_m[3]; /* Lowest corner, in the map. */
  double size_m;
  uint64_t cells; /* Of the finest resolution. */
  bool is_occupied;
} OctreeLeaf;

typedef void (*OctreeVisitor)(const OctreeLeaf* leaf, void* context);

/* `binary`: two bits for each child. False when the bytes are no such tree. */
bool ReadBinaryOctree(const uint8_t* data, size_t size, double resolution_m, OctreeVisitor visit, void* context);

/* `full`: the log-odds of each node and a byte that tells its children. */
bool ReadFullOctree(const uint8_t* data, size_t size, double resolution_m, OctreeVisitor visit, void* context);

#endif
