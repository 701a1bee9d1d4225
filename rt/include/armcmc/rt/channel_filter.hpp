#pragma once

#include <linux/filter.h>

#include <string>
#include <vector>

namespace armcmc::rt {

/// Program of the kernel's socket filter (classic BPF) that drops LCM messages of some channels and lets everything
/// else pass.
///
/// On a multicast bus a process hears what it sends itself. At 1 kHz, with up to four messages per pack, each would
/// wake the thread that waits for packs, on the CPU that executes and publishes. What the filter drops wakes nobody.
/// @param channels  Names with prefix, at most kMaxChannelLength characters each.
/// @return Empty if there are so many channels that the kernel would refuse the program.
[[nodiscard]] std::vector<sock_filter> FilterWithout(const std::vector<std::string>& channels);

/// Attaches FilterWithout(channels) to a UDP socket.
/// @return false if the kernel refuses, also because of its limit of memory for a socket: then everything is heard.
bool DropChannels(int udp_socket, const std::vector<std::string>& channels) noexcept;

}  // namespace armcmc::rt
