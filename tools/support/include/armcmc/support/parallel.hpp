#pragma once

#include <cstddef>
#include <functional>

namespace armcmc::support {

/// Runs work(i) for i < count on both cores of a small machine. What is thrown in one of them ends both and is thrown
/// on. Inside such work it runs them one after the other: both cores are busy already. Not real-time.
void InParallel(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace armcmc::support
