/* A program of another vendor, in plain C, with nothing of Soffit but its IDL: subscribes to the scene of vehicle 1,
   decodes the octree and asks one question of each kind. Prints what it found, line by line; ends with 0 when
   everything was there and fitted together.

   cyclone_client DOMAIN */

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "dds/dds.h"
#include "octree.h"
#include "ros2.h"
#include "soffit.h"

static dds_entity_t participant;
static int failures = 0;

static void Check(bool condition, const char* what) {
  if (!condition) ++failures;
  printf("%s %s\n", condition ? "ok    " : "FAILED", what);
}

static dds_qos_t* Qos(bool is_latched) {
  dds_qos_t* qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(1));
  dds_qset_durability(qos, is_latched ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, is_latched ? 1 : 32);
  return qos;
}

static dds_entity_t MakeReader(const dds_topic_descriptor_t* type, const char* name, bool is_latched) {
  dds_qos_t* qos = Qos(is_latched);
  const dds_entity_t topic = dds_create_topic(participant, type, name, NULL, NULL);
  const dds_entity_t reader = dds_create_reader(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  return reader;
}

/* The first sample within 10 s, on loan from a reader that lives as long as the program; NULL without any. */
static const void* Await(const dds_topic_descriptor_t* type, const char* name, bool is_latched) {
  const dds_entity_t reader = MakeReader(type, name, is_latched);
  char what[256];
  void* sample = NULL;
  bool is_there = false;
  for (int i = 0; i < 1000 && !is_there; ++i) {
    dds_sample_info_t info;
    if (dds_read(reader, &sample, &info, 1, 1) > 0 && info.valid_data) {
      is_there = true;
    } else {
      if (sample != NULL) dds_return_loan(reader, &sample, 1);
      sample = NULL;
      dds_sleepfor(DDS_MSECS(10));
    }
  }
  snprintf(what, sizeof what, "%s is received", name);
  Check(is_there, what);
  return is_there ? sample : NULL;
}

/* ---- Questions ---- */

static dds_entity_t requests;
static dds_entity_t replies;
static uint32_t asked = 0;

static soffit_wire_SceneQuery Question(soffit_wire_QueryKind kind) {
  soffit_wire_SceneQuery query;
  memset(&query, 0, sizeof query);
  memcpy(query.id.client, "a client in C 16", 16);
  query.id.sequence_number = ++asked;
  query.kind = kind;
  query.vehicle_id = 1;
  return query;
}

/* The answer, on loan until the next question; NULL when there is none within 10 s. A question that got lost is sent
   again with the same id. */
static const soffit_wire_SceneReply* Ask(const soffit_wire_SceneQuery* query) {
  static void* sample = NULL;
  if (sample != NULL) dds_return_loan(replies, &sample, 1);
  sample = NULL;
  for (int i = 0; i < 10000; ++i) {
    dds_sample_info_t info;
    if (i % 1000 == 0) dds_write(requests, query);
    if (dds_take(replies, &sample, &info, 1, 1) > 0) {
      const soffit_wire_SceneReply* reply = sample;
      if (info.valid_data && reply->id.sequence_number == query->id.sequence_number &&
          memcmp(reply->id.client, query->id.client, 16) == 0) {
        return reply;
      }
      dds_return_loan(replies, &sample, 1);
      sample = NULL;
    }
    dds_sleepfor(DDS_MSECS(1));
  }
  return NULL;
}

static const soffit_wire_SceneReply* AskWell(const soffit_wire_SceneQuery* query, const char* what) {
  const soffit_wire_SceneReply* reply = Ask(query);
  Check(reply != NULL && reply->status == soffit_wire_ANSWER_OK, what);
  if (reply != NULL && reply->status != soffit_wire_ANSWER_OK) printf("       it says: %s\n", reply->message);
  return reply != NULL && reply->status == soffit_wire_ANSWER_OK ? reply : NULL;
}

static bool ConnectQuestions(void) {
  dds_qos_t* qos = Qos(false);
  const dds_entity_t topic =
      dds_create_topic(participant, &soffit_wire_SceneQuery_desc, "soffit/scene_query/v3", NULL, NULL);
  requests = dds_create_writer(participant, topic, qos, NULL);
  dds_delete_qos(qos);
  replies = MakeReader(&soffit_wire_SceneReply_desc, "soffit/scene_reply/v3", false);
  for (int i = 0; i < 1000; ++i) {
    dds_publication_matched_status_t readers;
    dds_subscription_matched_status_t writers;
    dds_get_publication_matched_status(requests, &readers);
    dds_get_subscription_matched_status(replies, &writers);
    if (readers.current_count > 0 && writers.current_count > 0) return true;
    dds_sleepfor(DDS_MSECS(10));
  }
  return false;
}

/* ---- The map ---- */

typedef struct {
  uint64_t free_cells;
  uint64_t occupied_cells;
  int leaves;
  OctreeLeaf samples[16]; /* Some leaves, spread over the tree. */
} Map;

static void Count(const OctreeLeaf* leaf, void* context) {
  Map* map = context;
  *(leaf->is_occupied ? &map->occupied_cells : &map->free_cells) += leaf->cells;
  if (map->leaves % 37 == 0) map->samples[map->leaves / 37 % 16] = *leaf;
  ++map->leaves;
}

static void CheckMap(void) {
  const octomap_msgs_msg_dds__Octomap_* binary =
      Await(&octomap_msgs_msg_dds__Octomap__desc, "rt/soffit/vehicle_1/octomap_binary", true);
  const octomap_msgs_msg_dds__Octomap_* full =
      Await(&octomap_msgs_msg_dds__Octomap__desc, "rt/soffit/vehicle_1/octomap_full", true);
  if (binary == NULL || full == NULL) return;
  Map from_binary;
  Map from_full;
  memset(&from_binary, 0, sizeof from_binary);
  memset(&from_full, 0, sizeof from_full);
  Check(binary->binary_ && strcmp(binary->id_, "OcTree") == 0, "the binary map says what it is");
  Check(!full->binary_ && full->resolution_ == binary->resolution_, "the full map says what it is");
  Check(ReadBinaryOctree(binary->data_._buffer, binary->data_._length, binary->resolution_, Count, &from_binary),
        "the binary map is decoded to its last byte");
  Check(ReadFullOctree(full->data_._buffer, full->data_._length, full->resolution_, Count, &from_full),
        "the full map is decoded to its last byte");
  Check(from_binary.free_cells == from_full.free_cells && from_binary.occupied_cells == from_full.occupied_cells,
        "both maps tell the same");
  printf("free_cells %llu\noccupied_cells %llu\n", (unsigned long long)from_binary.free_cells,
         (unsigned long long)from_binary.occupied_cells);
  Check(!ReadBinaryOctree(binary->data_._buffer, binary->data_._length - 1, binary->resolution_, Count, &from_full),
        "a map without its last byte is refused");

  bool is_alike = from_binary.leaves > 0;
  for (int i = 0; i < 16 && i < from_binary.leaves / 37; ++i) {
    const OctreeLeaf* leaf = &from_binary.samples[i];
    soffit_wire_SceneQuery query = Question(soffit_wire_QUERY_POINT);
    query.from_in_map_m.x = leaf->low_m[0] + 0.5 * leaf->size_m;
    query.from_in_map_m.y = leaf->low_m[1] + 0.5 * leaf->size_m;
    query.from_in_map_m.z = leaf->low_m[2] + 0.5 * leaf->size_m;
    const soffit_wire_SceneReply* reply = Ask(&query);
    is_alike = is_alike && reply != NULL && reply->status == soffit_wire_ANSWER_OK &&
               reply->occupancy ==
                   (leaf->is_occupied ? soffit_wire_OCCUPANCY_OCCUPIED : soffit_wire_OCCUPANCY_FREE);
  }
  Check(is_alike, "what is asked of a point is what the map has there");
}

/* ---- The rest of what ROS 2 sees ---- */

static void CheckRos(void) {
  const visualization_msgs_msg_dds__MarkerArray_* markers =
      Await(&visualization_msgs_msg_dds__MarkerArray__desc, "rt/soffit/vehicle_1/scene", true);
  if (markers != NULL) {
    bool has_model = false;
    for (uint32_t i = 0; i < markers->markers_._length; ++i) {
      const visualization_msgs_msg_dds__Marker_* marker = &markers->markers_._buffer[i];
      has_model = has_model || (strcmp(marker->ns_, "models") == 0 && marker->points_._length % 3 == 0 &&
                                marker->points_._length > 0);
    }
    Check(markers->markers_._length > 3 && markers->markers_._buffer[0].action_ == 3, "the markers begin anew");
    Check(has_model, "a model is among the markers");
  }
  const nav_msgs_msg_dds__Path_* corridor =
      Await(&nav_msgs_msg_dds__Path__desc, "rt/soffit/vehicle_1/corridor", true);
  Check(corridor != NULL && corridor->poses_._length == 2, "the corridor has an entry and an exit");
  const nav_msgs_msg_dds__Path_* waypoints =
      Await(&nav_msgs_msg_dds__Path__desc, "rt/soffit/vehicle_1/waypoints", true);
  Check(waypoints != NULL && waypoints->poses_._length > 0, "there are waypoints");
  const sensor_msgs_msg_dds__CompressedImage_* image = Await(
      &sensor_msgs_msg_dds__CompressedImage__desc, "rt/soffit/vehicle_1/camera/image_raw/compressed", true);
  Check(image != NULL && image->data_._length > 2 && image->data_._buffer[0] == 0xff && strstr(image->format_, "jpeg"),
        "the picture is a JPEG");
  const sensor_msgs_msg_dds__CameraInfo_* camera =
      Await(&sensor_msgs_msg_dds__CameraInfo__desc, "rt/soffit/vehicle_1/camera/camera_info", true);
  Check(camera != NULL && camera->k_[0] > 0.0 && camera->d_._length == 5, "the camera has its intrinsics");
  Check(image != NULL && camera != NULL && strcmp(image->header_.frame_id_, camera->header_.frame_id_) == 0,
        "picture and camera are of one frame");
  const geometry_msgs_msg_dds__PoseStamped_* pose =
      Await(&geometry_msgs_msg_dds__PoseStamped__desc, "rt/soffit/vehicle_1/pose", false);
  Check(pose != NULL && strcmp(pose->header_.frame_id_, "map") == 0, "the pose is in the map");
  const tf2_msgs_msg_dds__TFMessage_* moving = Await(&tf2_msgs_msg_dds__TFMessage__desc, "rt/tf", false);
  Check(moving != NULL && moving->transforms_._length == 1, "a frame moves");
  const tf2_msgs_msg_dds__TFMessage_* fixed = Await(&tf2_msgs_msg_dds__TFMessage__desc, "rt/tf_static", true);
  Check(fixed != NULL && fixed->transforms_._length > 0, "frames are fixed");
}

/* ---- Soffit's own topics, and a question of each kind ---- */

static void CheckOwnTopics(void) {
  Await(&soffit_wire_SceneObject_desc, "soffit/scene_object/v1", true);
  const soffit_wire_ClearanceDecision* decision =
      Await(&soffit_wire_ClearanceDecision_desc, "soffit/clearance_decision/v2", true);
  Check(decision != NULL && decision->verdict == soffit_wire_VERDICT_CLEAR && decision->has_corridor,
        "the decision is CLEAR and has a corridor");
  Check(decision != NULL && decision->binding == soffit_wire_BOUND_LEFT && decision->distance_to_surface_m > 0.1 &&
            decision->distance_to_surface_m < 1.0 && decision->corridor.bends_in_map_m._length == 0,
        "it names the binding margin and the distance to the model");
  const soffit_wire_BuildingModel* model =
      Await(&soffit_wire_BuildingModel_desc, "soffit/building_model/v1", true);
  if (model == NULL) return;
  printf("triangles %u\n", model->triangles._length);
  double volume_m3 = 0.0;
  for (uint32_t i = 0; i < model->triangles._length; ++i) {
    const soffit_wire_Vector3* v = model->vertices_in_map_m._buffer;
    const soffit_wire_Triangle t = model->triangles._buffer[i];
    volume_m3 += (v[t.a].x * (v[t.b].y * v[t.c].z - v[t.b].z * v[t.c].y) -
                  v[t.a].y * (v[t.b].x * v[t.c].z - v[t.b].z * v[t.c].x) +
                  v[t.a].z * (v[t.b].x * v[t.c].y - v[t.b].y * v[t.c].x)) / 6.0;
  }
  Check(fabs(volume_m3 - model->volume_m3) < 1e-6 * model->volume_m3, "the mesh is closed and holds its volume");
}

static void SetFrom(soffit_wire_SceneQuery* query, double x, double y, double z) {
  query->from_in_map_m.x = x;
  query->from_in_map_m.y = y;
  query->from_in_map_m.z = z;
}

static void SetTo(soffit_wire_SceneQuery* query, double x, double y, double z) {
  query->to_in_map_m.x = x;
  query->to_in_map_m.y = y;
  query->to_in_map_m.z = z;
}

/* About the building that is recognized, and the passage through it, whose middle is (x, y, z). */
static void CheckQuestions(void) {
  soffit_wire_SceneQuery query = Question(soffit_wire_QUERY_OBJECTS);
  const soffit_wire_SceneReply* reply = AskWell(&query, "QUERY_OBJECTS is answered");
  uint32_t wanted = 0;
  for (uint32_t i = 0; reply != NULL && i < reply->objects._length; ++i) {
    if (reply->objects._buffer[i].is_matched) wanted = reply->objects._buffer[i].object_id;
  }
  Check(wanted != 0, "one of the objects is the wanted one");
  const uint64_t revision = reply != NULL ? reply->scene_revision : 0;
  Check(revision > 0 && reply->mission_id > 0, "an answer names mission and revision");

  query = Question(soffit_wire_QUERY_CLEARANCE);
  query.object_id = wanted;
  reply = AskWell(&query, "QUERY_CLEARANCE is answered for the mission's vehicle");
  if (reply == NULL || reply->decisions._length == 0 || !reply->decisions._buffer[0].has_corridor) {
    Check(false, "there is a corridor");
    return;
  }
  const soffit_wire_Vector3 entry = reply->decisions._buffer[0].corridor.entry_in_map_m;
  const soffit_wire_Vector3 exit = reply->decisions._buffer[0].corridor.exit_in_map_m;
  const double x = 0.5 * (entry.x + exit.x);
  const double y = 0.5 * (entry.y + exit.y);
  const double z = 0.5 * (entry.z + exit.z);
  query.vehicle.radius_m = 50.0;
  query.vehicle.height_m = 50.0;
  query.id.sequence_number = ++asked;
  reply = AskWell(&query, "QUERY_CLEARANCE is answered for another vehicle");
  Check(reply != NULL && reply->decisions._length > 0 &&
            reply->decisions._buffer[0].verdict != soffit_wire_VERDICT_CLEAR,
        "a huge vehicle does not fit");

  query = Question(soffit_wire_QUERY_BOX);
  SetFrom(&query, x - 0.2, y - 0.2, z - 0.2);
  SetTo(&query, x + 0.2, y + 0.2, z + 0.2);
  query.resolution_m = 0.1;
  reply = AskWell(&query, "QUERY_BOX is answered");
  Check(reply != NULL && reply->occupancy == soffit_wire_OCCUPANCY_FREE && reply->grid.occupancy._length == 64,
        "the middle of the passage is free");

  query = Question(soffit_wire_QUERY_RAY);
  SetFrom(&query, x, y, z);
  SetTo(&query, x, y, z + 10.0);
  reply = AskWell(&query, "QUERY_RAY is answered");
  Check(reply != NULL && reply->ray != soffit_wire_RAY_FREE && reply->distance_m < 5.0, "the passage has a soffit");
  query.id.sequence_number = ++asked;
  query.range_m = 0.1;
  reply = AskWell(&query, "QUERY_RAY with a range is answered");
  Check(reply != NULL && reply->ray == soffit_wire_RAY_FREE, "the ray is free as far as that");

  query = Question(soffit_wire_QUERY_NEAREST);
  SetFrom(&query, x, y, z);
  reply = AskWell(&query, "QUERY_NEAREST is answered");
  Check(reply != NULL && reply->surface.is_found && reply->surface.distance_m > 0.0 && reply->nearest_unknown.is_found,
        "model and unknown space are near, and the passage is outside the model");

  query = Question(soffit_wire_QUERY_COLUMN);
  SetFrom(&query, x, y, 0.0);
  reply = AskWell(&query, "QUERY_COLUMN is answered");
  Check(reply != NULL && reply->has_height && reply->height_m > z && reply->objects._length == 1,
        "the building is above its passage");

  query = Question(soffit_wire_QUERY_WAY);
  query.vehicle.radius_m = 0.1;
  query.vehicle.height_m = 0.1;
  query.vehicle.safety_margin_m = 0.05;
  SetFrom(&query, 0.5 * (x + entry.x), 0.5 * (y + entry.y), z);
  SetTo(&query, 0.5 * (x + exit.x), 0.5 * (y + exit.y), z);
  reply = AskWell(&query, "QUERY_WAY is answered");
  Check(reply != NULL && reply->verdict == soffit_wire_VERDICT_CLEAR, "a small vehicle may fly through");
  query.kind = soffit_wire_QUERY_PATH;
  query.id.sequence_number = ++asked;
  reply = AskWell(&query, "QUERY_PATH is answered");
  Check(reply != NULL && reply->verdict == soffit_wire_VERDICT_CLEAR && reply->path_in_map_m._length >= 2,
        "there is a path through");
  SetTo(&query, exit.x + 500.0, exit.y, exit.z);
  query.id.sequence_number = ++asked;
  reply = AskWell(&query, "QUERY_PATH to where nothing is known is answered");
  Check(reply != NULL && reply->verdict != soffit_wire_VERDICT_CLEAR && reply->cells._length > 0,
        "what is in the way is named");

  query = Question(soffit_wire_QUERY_CHANGES);
  reply = AskWell(&query, "QUERY_CHANGES is answered");
  Check(reply != NULL && reply->changes._length > 0 && reply->changed_cells > 0, "since nothing everything is new");
  query = Question(soffit_wire_QUERY_REVISIONS);
  reply = AskWell(&query, "QUERY_REVISIONS is answered");
  Check(reply != NULL && reply->revisions._length > 0 &&
            reply->revisions._buffer[reply->revisions._length - 1].scene_revision >= revision,
        "the revision is listed");

  query = Question(soffit_wire_QUERY_POINT);
  query.from_in_map_m.x = NAN;
  reply = Ask(&query);
  Check(reply != NULL && reply->status == soffit_wire_ANSWER_BAD_REQUEST && strlen(reply->message) > 0,
        "a question about nowhere is refused in words");
  query = Question(soffit_wire_QUERY_POINT);
  query.vehicle_id = 4711;
  reply = Ask(&query);
  Check(reply != NULL && reply->status == soffit_wire_ANSWER_NO_SCENE, "an unknown vehicle has no scene");
}

int main(int argc, char** argv) {
  if (argc != 2) {
    fprintf(stderr, "usage: %s DOMAIN\n", argv[0]);
    return 2;
  }
  participant = dds_create_participant((dds_domainid_t)atoi(argv[1]), NULL, NULL);
  if (participant < 0) {
    fprintf(stderr, "cannot join the domain: %s\n", dds_strretcode(-participant));
    return 2;
  }
  Check(ConnectQuestions(), "the service is found");
  CheckMap();
  CheckRos();
  CheckOwnTopics();
  CheckQuestions();
  dds_delete(participant);
  printf("%d failures\n", failures);
  return failures == 0 ? 0 : 1;
}
