#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "shared/options/options.h"
#include "shared/result/result.h"

namespace soffit {

/// How a program takes part in one DDS domain.
struct DdsOptions {
  int domain_id = 0;
  bool udp_only = false;
  std::vector<std::string> interfaces;
  std::vector<std::string> peers;
  std::string profile = "local";
  int flow_bytes_per_ms = 0;

  template <class Self, class Visitor>
  static void Visit(Self& self, Visitor&& field) {
    field("domain_id", self.domain_id, OptionInfo{0, 230, "", "DDS domain"});
    field("udp_only", self.udp_only, OptionInfo{0, 0, "", "No shared memory: what a radio link needs"});
    field("interfaces", self.interfaces,
          OptionInfo{0, 0, "", "IPv4 addresses of the only interfaces to use; empty: all (with udp_only)"});
    field("peers", self.peers,
          OptionInfo{0, 0, "", "Hosts to look for where there is no multicast; empty: multicast"});
    field("profile", self.profile,
          OptionInfo{
              0, 0, "",
              "The link: local (one machine), wired (100 Mbit/s), wifi (20), lte (6), telemetry (0.2); sets "
              "fragments, flow, heartbeats and the size of pictures; the same at both ends"});
    field("flow_bytes_per_ms", self.flow_bytes_per_ms,
          OptionInfo{
              0, 1000000, "B/ms",
              "Budget of all large data where the link is another one: about 80 % of it (2800: 28 Mbit/s); "
              "0: that of the profile"});
  }
};

/// What agents and the service start from for the link between them, and the service and its clients for
/// theirs. The local domain is that of ROS 2 where ROS_DOMAIN_ID is set; a value that is no domain is refused
/// by Join().
DdsOptions DefaultRadioOptions();
DdsOptions DefaultLocalOptions();

/// A reader or writer that another member of the domain has.
struct RemoteEndpoint {
  std::string topic;
  std::string type;
  std::string participant;  ///< Its name in quotes, or its id when it has none.
  bool is_writer = false;
  bool is_reliable = false;
  bool is_latched = false;  ///< Late joiners get, or want, what was sent before.
};

namespace dds_internal {
class Bus;
}

/// Parts of large values, as they are sent.
struct FragmentCounts {
  std::uint64_t sent = 0;
  std::uint64_t sent_again = 0;  ///< Of these: had been sent before.
};

/// A member of one DDS domain. Readers and writers that are made from it may outlive it.
///
/// All callbacks of its readers, and `on_problem`, run on one thread of the participant, one after another;
/// `on_problem` also runs in a writer's Write(). A callback has to return soon, and must not destroy a reader
/// or writer of the same participant.
class Participant {
 public:
  using ProblemHandler = std::function<void(const std::string&)>;

  /// @param on_problem  Told in words of malformed messages, of peers whose types or quality of service do
  /// not fit, and
  ///                    of failed writes. May be called often.
  static Result<Participant> Join(const std::string& name, const DdsOptions& options,
                                  ProblemHandler on_problem);

  /// What has been discovered so far; complete about a second after joining.
  std::vector<RemoteEndpoint> Discovered() const;

  /// Since joining; counted with `udp_only`.
  FragmentCounts CountFragments() const;

  const std::shared_ptr<dds_internal::Bus>& bus() const { return bus_; }

 private:
  explicit Participant(std::shared_ptr<dds_internal::Bus> bus) : bus_(std::move(bus)) {}
  std::shared_ptr<dds_internal::Bus> bus_;
};

}  // namespace soffit
