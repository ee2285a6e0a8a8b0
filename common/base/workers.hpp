#pragma once

#include <cstddef>
#include <functional>

namespace prehend {

/// Calls work(0) .. work(count-1), each once, in `threads` threads (0: as many as the machine has
/// cores; never more than 256, nor than there is work), and done(n) in the calling thread when n
/// are done, now and then and after the last. An exception of the work is thrown on in the calling
/// thread.
void share_work(std::size_t count, unsigned threads, const std::function<void(std::size_t)>& work,
                const std::function<void(std::size_t)>& done);

}  // namespace prehend
