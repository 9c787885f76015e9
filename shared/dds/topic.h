#pragma once

namespace soffit {

/// What a topic carries decides its quality of service (table in shared/dds/README.md).
enum class TopicKind {
  kPicture,  ///< Large and whole: reliable, flow-controlled, refused by Write() when the link is full.
  kState,    ///< Newest only: best effort, with a deadline and liveliness by each write.
  kCommand,  ///< Reliable, never latched, gone after `kCommandLifespan_s`.
  kLatched,  ///< Reliable, the newest of each key is kept for late joiners.
  kQuery,    ///< Reliable, volatile: a request or a reply.
  kStream,   ///< Reliable, volatile: many small values in order, as ROS 2 sends transforms and poses.
};

inline constexpr double kCommandLifespan_s = 5.0;
inline constexpr double kStateLease_s = 1.0;     ///< A writer that is silent for so long is taken for dead.
inline constexpr double kStateDeadline_s = 0.6;  ///< Greatest time between two writes.

// A topic is a struct that Reader and Writer are instantiated with:
//
//     struct CaptureTopic {
//       using Value = Capture;                            // what programs read and write
//       using Support = wire::CapturePubSubType;          // generated; Support::type is what is sent
//       static constexpr const char* kName = "soffit/capture/v1";
//       static constexpr TopicKind kKind = TopicKind::kPicture;
//       static Support::type ToWire(const Value& value);
//       static Result<Value> FromWire(const Support::type& message);
//     };

}  // namespace soffit
