#pragma once
// Images of a running render in the viewer tev, by its TCP protocol (Ipc.cpp in tev's sources, github.com/Tom94/tev).

#include <memory>
#include <string>

#include "core/image/image.h"
#include "experiments/engine/progress.h"

namespace ulam {

/// Sends from a thread of its own, so that a viewer that is not there, goes away or stalls holds nobody up. Where it is
/// not connected it tries to connect before each image.
class TevViewer {
public:
    /// `address`: HOST:PORT, an IPv6 address in brackets; fails with Usage where it is something else. In `show` or the
    /// destructor a message says, once, why images do not get through.
    TevViewer(const std::string& address, Progress& progress);
    /// Waits for the last image to be sent, a few seconds at most.
    ~TevViewer();

    /// Shows an image under a name, in place of the one that had it before. Returns at once. Of images that wait only
    /// the last is kept: a slow viewer misses some.
    void show(const std::string& name, Image image);

private:
    class Sender;
    std::unique_ptr<Sender> sender_;
};

}  // namespace ulam
