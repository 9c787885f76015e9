#pragma once

#include <dirent.h>
#include <pwd.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

namespace soffit::test {

/// A PostgreSQL server of Debian's packages with a folder, a database and a socket of its own, that is gone
/// with this object. It listens on no port, and runs as `nobody` where the tests run as root.
class Postgres {
 public:
  /// Check IsThere() first.
  Postgres() {
    char folder[] = "/tmp/soffit-postgres-XXXXXX";
    folder_ = mkdtemp(folder);
    if (geteuid() == 0) {
      const passwd* nobody = getpwnam("nobody");
      if (chown(folder_.c_str(), nobody->pw_uid, nobody->pw_gid) != 0) return;
    }
    Await(Spawn({BinFolder() / "initdb", "-D", folder_ / "data", "-U", "soffit", "-A", "trust", "--no-sync",
                 "--locale=C.UTF-8"}));
    Start();
  }
  ~Postgres() {
    if (server_ > 0) End(SIGINT);
    std::filesystem::remove_all(folder_);
  }
  Postgres(const Postgres&) = delete;
  Postgres& operator=(const Postgres&) = delete;

  static bool IsThere() { return std::filesystem::exists(BinFolder() / "initdb"); }

  void Start() {
    server_ = Spawn({BinFolder() / "postgres", "-D", folder_ / "data", "-k", folder_, "-c",
                     "listen_addresses=", "-c", "fsync=off"});
    for (int i = 0; i < 300; ++i) {
      const std::vector<std::string> ask = {BinFolder() / "pg_isready", "-q", "-h", folder_};
      if (Await(Spawn(ask)) == 0) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  }
  void End(int signal) {
    kill(server_, signal);
    Await(server_);
    server_ = 0;
  }

  std::string Connection() const { return "PG:host=" + folder_.string() + " user=soffit dbname=postgres"; }

 private:
  static std::filesystem::path BinFolder() {
    const std::filesystem::path all = "/usr/lib/postgresql";
    std::error_code ignored;
    for (const auto& version : std::filesystem::directory_iterator(all, ignored))
      return version.path() / "bin";
    return all;
  }

  pid_t Spawn(const std::vector<std::string>& command) const {
    const passwd* nobody = geteuid() == 0 ? getpwnam("nobody") : nullptr;
    const pid_t child = fork();
    if (child != 0) return child;
    if (nobody != nullptr && (setgid(nobody->pw_gid) != 0 || setuid(nobody->pw_uid) != 0)) _exit(1);
    if (chdir(folder_.c_str()) != 0 || freopen("log", "a", stdout) == nullptr || dup2(1, 2) < 0) _exit(1);
    std::vector<char*> words;
    for (const std::string& word : command) words.push_back(const_cast<char*>(word.c_str()));
    words.push_back(nullptr);
    execv(words[0], words.data());
    _exit(1);
  }
  static int Await(pid_t child) {
    int status = 0;
    waitpid(child, &status, 0);
    return status;
  }

  std::filesystem::path folder_;
  pid_t server_ = 0;
};

}  // namespace soffit::test
