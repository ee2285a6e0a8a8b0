// with_domain COMMAND...: becomes the command, on a domain that no other test on this machine has.
// PREHEND_LAB_DOMAIN is the domain, LEASED_PORT the first of twenty ports of its own;
// DOMAIN_LEASED_TO is the process, so that a script knows whether it has a domain of its own or has
// heard of its caller's.
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>

#include "tests/support/domains/domain_lease.hpp"

int main(int argc, char** argv) {
  if (argc < 2) {
    std::cerr << "with_domain COMMAND...\n";
    return 2;
  }
  try {
    const prehend::test::DomainLease lease;
    lease.keep_over_exec();
    ::setenv("PREHEND_LAB_DOMAIN", std::to_string(lease.domain()).c_str(), 1);
    ::setenv("LEASED_PORT", std::to_string(lease.port()).c_str(), 1);
    ::setenv("DOMAIN_LEASED_TO", std::to_string(::getpid()).c_str(), 1);
    ::execvp(argv[1], argv + 1);
    std::perror(argv[1]);
  } catch (const std::exception& error) {
    std::cerr << "with_domain: " << error.what() << "\n";
  }
  return 3;
}
