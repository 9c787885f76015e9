#include "test/sim/camera/http_port.h"

#include <httplib.h>

#include <stdexcept>
#include <string>

namespace soffit::sim {

int BindAlone(httplib::Server& http, int port) {
  constexpr char kHost[] = "127.0.0.1";
  http.set_socket_options([](socket_t socket) {  // The default lets two programs share a port unnoticed.
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
  const int bound = port == 0 ? http.bind_to_any_port(kHost) : http.bind_to_port(kHost, port) ? port : -1;
  if (bound <= 0) {
    throw std::runtime_error("HTTP port " + std::to_string(port) + " of " + kHost +
                             " cannot be had; another program may use it (0 takes any free one)");
  }
  return bound;
}

}  // namespace soffit::sim
