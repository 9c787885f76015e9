#pragma once

#include <functional>
#include <memory>
#include <string>

#include "shared/result/result.h"

namespace soffit::sim {

/// HTTP on 127.0.0.1 by which a test reaches into a run: POST /disturb (the words are the body; 200, or 400
/// and what is wrong), GET /truth (JSON).
class ControlServer {
 public:
  using Disturb = std::function<Status(const std::string& words)>;
  using Describe = std::function<std::string()>;

  /// Both are called from the server's thread. Port 0: a free one. @throws std::runtime_error  the port
  /// cannot be had.
  ControlServer(int port, Disturb disturb, Describe describe);
  ~ControlServer();  ///< Stops listening.
  ControlServer(const ControlServer&) = delete;
  ControlServer& operator=(const ControlServer&) = delete;

  int port() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace soffit::sim
