// Two tests at once never have the same domain, whatever becomes of either of them.
#include "tests/support/domains/domain_lease.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <future>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/paths/paths.hpp"

namespace prehend::test {
namespace {

class Domains : public testing::Test {
 protected:
  Domains()
      : file_(std::filesystem::temp_directory_path() /
              ("prehend-domains-" + std::to_string(::getpid()))) {}
  ~Domains() override { std::filesystem::remove(file_); }

  std::filesystem::path file_;
};

/// A process that leases a domain and keeps it until it is killed.
class Holder {
 public:
  explicit Holder(const std::filesystem::path& file, int last) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) throw std::runtime_error("no pipe");
    process_ = ::fork();
    if (process_ == 0) {
      const DomainLease lease(file, last);
      const int domain = lease.domain();
      if (::write(ends[1], &domain, sizeof domain) != sizeof domain) ::_exit(1);
      while (true) ::pause();
    }
    ::close(ends[1]);
    told_ = ends[0];
  }
  ~Holder() { kill(); }
  Holder(const Holder&) = delete;
  Holder& operator=(const Holder&) = delete;

  int domain() const {
    int domain = 0;
    return ::read(told_, &domain, sizeof domain) == sizeof domain ? domain : 0;
  }
  void kill() {
    if (process_ <= 0) return;
    ::kill(process_, SIGKILL);
    ::waitpid(process_, nullptr, 0);
    ::close(told_);
    process_ = 0;
  }

 private:
  pid_t process_ = 0;
  int told_ = -1;
};

TEST_F(Domains, ProcessesAtOnceHaveDifferentOnes) {
  std::vector<std::unique_ptr<Holder>> holders;
  for (int i = 0; i < 10; ++i) holders.push_back(std::make_unique<Holder>(file_, 11));
  std::set<int> domains;
  for (const auto& holder : holders) domains.insert(holder->domain());
  EXPECT_EQ(domains.size(), 10u);
  const DomainLease last(file_, 11);
  domains.insert(last.domain());
  EXPECT_EQ(domains.size(), 11u);
  EXPECT_EQ(*domains.begin(), 1) << "0 stays the users'";
  EXPECT_EQ(*domains.rbegin(), 11);
}

TEST_F(Domains, TwoOfOneProcessDiffer) {
  const DomainLease one(file_, 2), other(file_, 2);
  EXPECT_NE(one.domain(), other.domain());
}

TEST_F(Domains, WhatAKilledProcessHadIsFree) {
  Holder holder(file_, 1);
  ASSERT_EQ(holder.domain(), 1);
  auto next = std::async(std::launch::async, [&] { return DomainLease(file_, 1).domain(); });
  holder.kill();
  EXPECT_EQ(next.get(), 1);
}

TEST_F(Domains, WhereAllAreTakenItWaitsForTheNextThatIsFree) {
  auto one = std::make_unique<DomainLease>(file_, 2),
       other = std::make_unique<DomainLease>(file_, 2);
  const int free = other->domain();
  std::atomic<bool> given = false;
  auto next = std::async(std::launch::async, [&] {
    const DomainLease lease(file_, 2);
    EXPECT_TRUE(given) << "it did not wait";
    return lease.domain();
  });
  // It is sound however long this is; a lease that does not wait is through by then.
  EXPECT_EQ(next.wait_for(std::chrono::milliseconds(200)), std::future_status::timeout);
  given = true;
  other.reset();
  EXPECT_EQ(next.get(), free);
}

/// A script of a test, which tells its domain and runs until its input ends.
class Script {
 public:
  Script() {
    int in[2], out[2];
    if (::pipe2(in, O_CLOEXEC) != 0 || ::pipe2(out, O_CLOEXEC) != 0)
      throw std::runtime_error("no pipe");
    const std::string program = in_programs("with_domain");
    process_ = ::fork();
    if (process_ == 0) {
      ::dup2(in[0], 0);
      ::dup2(out[1], 1);
      ::execl(program.c_str(), program.c_str(), "sh", "-c",
              "[ $DOMAIN_LEASED_TO = $$ ] && echo $PREHEND_LAB_DOMAIN; read _", nullptr);
      ::_exit(1);
    }
    ::close(in[0]);
    ::close(out[1]);
    input_ = in[1];
    output_ = out[0];
  }
  ~Script() {
    ::close(input_);
    ::close(output_);
    ::waitpid(process_, nullptr, 0);
  }
  Script(const Script&) = delete;
  Script& operator=(const Script&) = delete;

  std::string domain() const {
    char text[16];
    const ssize_t size = ::read(output_, text, sizeof text);
    return size > 0 ? std::string(text, static_cast<std::size_t>(size - 1)) : "";
  }

 private:
  pid_t process_ = 0;
  int input_ = -1, output_ = -1;
};

TEST_F(Domains, AScriptHasOneForItsLife) {
  const Script one, other;
  const DomainLease ours;
  const std::set<std::string> domains{one.domain(), other.domain(), std::to_string(ours.domain())};
  EXPECT_EQ(domains.size(), 3u);
  EXPECT_FALSE(domains.contains("")) << "a script has none";
}

}  // namespace
}  // namespace prehend::test
