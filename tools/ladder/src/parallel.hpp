#pragma once

#include <cstddef>
#include <functional>

namespace armcmc::ladder {

/// Runs work(i) for i < count on both cores of a small machine. What is thrown in one of them ends both and is thrown
/// on.
void InParallel(std::size_t count, const std::function<void(std::size_t)>& work);

}  // namespace armcmc::ladder
