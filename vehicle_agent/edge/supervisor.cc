#include "vehicle_agent/edge/supervisor.h"

#include <sys/stat.h>
#include <systemd/sd-daemon.h>
#include <unistd.h>

#include <cstdlib>

namespace soffit {
namespace {

constexpr double kMargin = 4.0;  // So many times more often than the watchdog asks for.

double ReadWatchdogPeriod_s() {
  std::uint64_t period_us = 0;
  return sd_watchdog_enabled(0, &period_us) > 0 ? 1e-6 * static_cast<double>(period_us) : 0.0;
}

}  // namespace

Supervisor::Supervisor() : period_s_(ReadWatchdogPeriod_s()) {}

void Supervisor::SayReady() const { sd_notify(0, "READY=1"); }

void Supervisor::SayAlive(Instant now) {
  if (period_s_ <= 0.0 || SecondsBetween(said_, now) < period_s_ / kMargin) return;
  said_ = now;
  sd_notify(0, "WATCHDOG=1");
}

void Supervisor::SayStatus(const std::string& status) const { sd_notify(0, ("STATUS=" + status).c_str()); }

bool LogsToJournal() {
  const char* const journal = std::getenv("JOURNAL_STREAM");
  struct stat error {};
  if (journal == nullptr || fstat(STDERR_FILENO, &error) != 0) return false;
  return journal == std::to_string(error.st_dev) + ":" + std::to_string(error.st_ino);
}

}  // namespace soffit
