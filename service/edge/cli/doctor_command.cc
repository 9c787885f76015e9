#include <arpa/inet.h>
#include <fastrtps/config.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/timex.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <opencv2/core/version.hpp>
#include <sstream>
#include <thread>

#include "service/edge/cli/commands.h"
#include "service/edge/cli/request_client.h"
#include "service/edge/live/service_options.h"
#include "shared/options/yaml.h"

namespace soffit {
namespace {

namespace fs = std::filesystem;

/// One thing that was looked at, for a person.
struct Diagnosis {
  enum class Level { kGood, kNote, kBad };
  Level level = Level::kBad;
  std::string what;
  std::string advice;
};

Diagnosis Good(std::string what) { return {Diagnosis::Level::kGood, std::move(what), ""}; }
Diagnosis Note(std::string what, std::string advice) {
  return {Diagnosis::Level::kNote, std::move(what), std::move(advice)};
}
Diagnosis Bad(std::string what, std::string advice) {
  return {Diagnosis::Level::kBad, std::move(what), std::move(advice)};
}

struct Interface {
  std::string name;
  std::string address;
  int mtu_bytes = 0;
  bool has_multicast = false;
};

int MtuOf(const std::string& name) {
  const int handle = socket(AF_INET, SOCK_DGRAM, 0);
  if (handle < 0) return 0;
  ifreq request{};
  name.copy(request.ifr_name, sizeof(request.ifr_name) - 1);
  const int mtu_bytes = ioctl(handle, SIOCGIFMTU, &request) == 0 ? request.ifr_mtu : 0;
  close(handle);
  return mtu_bytes;
}

std::vector<Interface> ListInterfaces() {
  std::vector<Interface> interfaces;
  ifaddrs* list = nullptr;
  if (getifaddrs(&list) != 0) return interfaces;
  for (const ifaddrs* item = list; item != nullptr; item = item->ifa_next) {
    const bool is_usable =
        item->ifa_addr != nullptr && item->ifa_addr->sa_family == AF_INET && (item->ifa_flags & IFF_UP) != 0;
    if (!is_usable) continue;
    char text[INET_ADDRSTRLEN] = {};
    inet_ntop(AF_INET, &reinterpret_cast<const sockaddr_in*>(item->ifa_addr)->sin_addr, text, sizeof(text));
    interfaces.push_back(
        {item->ifa_name, text, MtuOf(item->ifa_name), (item->ifa_flags & IFF_MULTICAST) != 0});
  }
  freeifaddrs(list);
  return interfaces;
}

void CheckInterfaces(const ServiceOptions& options, std::vector<Diagnosis>& found) {
  constexpr int kLeastMtu_bytes = 1280;
  const std::vector<Interface> interfaces = ListInterfaces();
  bool has_network = false;
  for (const Interface& interface : interfaces) {
    std::ostringstream text;
    text << "interface " << interface.name << ": " << interface.address << ", MTU " << interface.mtu_bytes
         << (interface.has_multicast ? ", multicast" : ", no multicast");
    const bool is_loopback = interface.address.rfind("127.", 0) == 0;
    has_network = has_network || !is_loopback;
    if (interface.mtu_bytes < kLeastMtu_bytes) {
      found.push_back(
          Note(text.str(), "a small MTU splits pictures into many packets: raise it if the link allows"));
    } else if (!interface.has_multicast && !is_loopback && options.radio.peers.empty()) {
      found.push_back(
          Note(text.str(), "without multicast vehicles are found only by radio.peers in the configuration"));
    } else {
      found.push_back(Good(text.str()));
    }
  }
  if (!has_network) {
    found.push_back(
        Note("no network interface is up but loopback", "only programs on this machine will be found"));
  }
  for (const std::string& wanted : options.radio.interfaces) {
    const bool is_there = std::any_of(interfaces.begin(), interfaces.end(), [&](const Interface& interface) {
      return interface.address == wanted;
    });
    if (!is_there) {
      found.push_back(Bad("radio.interfaces names " + wanted + ", which no interface of this machine has",
                          "correct the configuration, or bring that interface up"));
    }
  }
}

void CheckSocketBuffer(const std::string& name, std::vector<Diagnosis>& found) {
  constexpr long kWanted_bytes = 4L << 20;
  long bytes = 0;
  std::ifstream("/proc/sys/net/core/" + name) >> bytes;
  const std::string text = "net.core." + name + " is " + std::to_string(bytes / 1024) + " KiB";
  if (bytes >= kWanted_bytes) return found.push_back(Good(text));
  found.push_back(Note(text, "large pictures may be lost and sent again: sysctl -w net.core." + name + "=" +
                                 std::to_string(kWanted_bytes)));
}

void CheckClock(std::vector<Diagnosis>& found) {
  timex clock{};
  const int state = adjtimex(&clock);
  if (state >= 0 && state != TIME_ERROR && (clock.status & STA_UNSYNC) == 0) {
    return found.push_back(
        Good("the clock is synchronized, to within " + std::to_string(clock.maxerror / 1000) + " ms"));
  }
  found.push_back(Note("the clock is not synchronized",
                       "agents on other machines refuse commands that look old: run chrony or another NTP "
                       "client here and there"));
}

void CheckSharedMemory(std::vector<Diagnosis>& found) {
  std::error_code problem;
  std::size_t leftovers = 0;
  for (const auto& entry : fs::directory_iterator("/dev/shm", problem)) {
    leftovers += entry.path().filename().string().rfind("fastrtps_", 0) == 0;
  }
  const fs::space_info space = fs::space("/dev/shm", problem);
  constexpr std::uintmax_t kWanted_bytes = 64U << 20U;
  if (problem)
    return found.push_back(Bad("/dev/shm cannot be read: " + problem.message(), "mount a tmpfs there"));
  if (space.available < kWanted_bytes) {
    return found.push_back(Bad("/dev/shm has " + std::to_string(space.available >> 20U) + " MiB left",
                               "DDS needs room there: stop all DDS programs, then run: fastdds shm clean"));
  }
  found.push_back(Good("/dev/shm has " + std::to_string(space.available >> 20U) + " MiB left, " +
                       std::to_string(leftovers) + " segments of DDS in it"));
}

void CheckDomain(const std::string& name, const DdsOptions& options, std::vector<Diagnosis>& found) {
  const auto participant = Participant::Join("soffit doctor", options, {});
  if (participant.ok()) {
    return found.push_back(
        Good("DDS domain " + std::to_string(options.domain_id) + " (" + name + ") can be joined"));
  }
  found.push_back(Bad(name + ": " + participant.error().message, "see the interfaces above"));
}

void CheckService(const ServiceOptions& options, std::vector<Diagnosis>& found) {
  const auto participant = Participant::Join("soffit doctor", options.local, {});
  if (!participant.ok()) return;
  Writer<SceneQueryTopic> writer(participant.value());
  if (writer.WaitForReader(std::chrono::seconds(2))) return found.push_back(Good("a soffitd is running"));
  found.push_back(Note("no soffitd is found on the local domain",
                       "start it, or give the configuration that it runs with"));
}

void CheckBuild(std::vector<Diagnosis>& found) {
  const std::string versions = std::string("Fast DDS ") + FASTRTPS_VERSION_STR + ", OpenCV " + CV_VERSION +
                               ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
  found.push_back(Good(versions));
#ifdef __OPTIMIZE__
  found.push_back(Good("an optimized build"));
#else
  found.push_back(Note("a build without optimization",
                       "decisions take many times as long: build with the preset 'release'"));
#endif
}

void Print(const Diagnosis& diagnosis) {
  const char* mark = diagnosis.level == Diagnosis::Level::kGood   ? "ok  "
                     : diagnosis.level == Diagnosis::Level::kNote ? "note"
                                                                  : "BAD ";
  std::cout << mark << "  " << diagnosis.what << '\n';
  if (!diagnosis.advice.empty()) std::cout << "      -> " << diagnosis.advice << '\n';
}

void RunDoctor(const std::string& config_file) {
  ServiceOptions options;
  std::vector<Diagnosis> found;
  if (!config_file.empty()) {
    const auto read = ReadOptionsFile<ServiceOptions>(config_file);
    if (read.ok()) options = read.value();
    found.push_back(read.ok() ? Good(config_file + " is well formed")
                              : Bad(read.error().message, "correct that line"));
  }
  CheckBuild(found);
  CheckInterfaces(options, found);
  CheckSocketBuffer("rmem_max", found);
  CheckSocketBuffer("wmem_max", found);
  CheckSharedMemory(found);
  CheckClock(found);
  CheckDomain("radio", options.radio, found);
  CheckDomain("local", options.local, found);
  CheckService(options, found);
  for (const Diagnosis& diagnosis : found) Print(diagnosis);
  const bool is_ill = std::any_of(found.begin(), found.end(),
                                  [](const Diagnosis& d) { return d.level == Diagnosis::Level::kBad; });
  if (is_ill) throw CLI::RuntimeError(1);
}

}  // namespace

void AddDoctorCommand(CLI::App& app) {
  CLI::App* command = app.add_subcommand(
      "doctor", "Says what is wrong with this machine's set-up (exit code 1: something is)");
  const auto config_file = std::make_shared<std::string>();
  command->add_option("--config", *config_file, "The configuration of soffitd");
  command->callback([config_file] { RunDoctor(*config_file); });
}

}  // namespace soffit
