#pragma once

#include <string>

#include "vehicle_agent/vehicle/vehicle.h"

namespace soffit {

/// systemd, when it started this program (sd_notify(3)); else nobody.
class Supervisor {
 public:
  Supervisor();

  void SayReady() const;
  /// To be called often: a program that hangs is started anew.
  void SayAlive(Instant now);
  void SayStatus(const std::string& status) const;

 private:
  double period_s_;  ///< Of the watchdog; 0: there is none.
  Instant said_;
};

/// Whether what goes to standard error ends in systemd's journal (JOURNAL_STREAM in systemd.exec(5)).
bool LogsToJournal();

}  // namespace soffit
