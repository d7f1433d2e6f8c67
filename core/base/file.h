#pragma once
// Whole files in and out.

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "core/base/error.h"

namespace ulam {

/// A file that is there and cannot be read now, for want of permission or for an error of the disk. That does not mean that
/// it is damaged. Its code is InputMissing.
class UnreadableFile : public Error {
public:
    using Error::Error;
};

/// open(2) again where a signal interrupts it, closed in programs that this one starts; below 0 with errno.
int openFile(const std::filesystem::path& path, int flags);

/// The bytes of a file. Fails with InputMissing and the system's reason when there is none, with UnreadableFile when it
/// cannot be read, and with InvalidConfig when it holds more than `maxBytes`.
std::string readFile(const std::filesystem::path& path, std::size_t maxBytes = std::numeric_limits<std::size_t>::max());

/// Replaces a file so that readers, and a run continued after a kill, see all of the old bytes or all of the new ones:
/// a temporary file in the same folder is written, flushed to disk and renamed. A symbolic link is followed; what is
/// not a regular file (a device, a pipe) is written in place. Fails with CannotWrite and the system's reason, leaving
/// the old file untouched and no temporary file behind. The folder must exist.
void writeFileAtomically(const std::filesystem::path& path, std::string_view bytes);
/// The same of parts that follow each other.
void writeFileAtomically(const std::filesystem::path& path, std::span<const std::string_view> parts);

/// Fails like readFile where a file cannot be opened.
void requireReadable(const std::filesystem::path& path);

/// The host's name, of letters, digits, dots, dashes and underscores.
std::string hostName();

/// A name that this process uses once, for a file or folder that is renamed when it is whole: ".ulam-HOST-PROCESS-NUMBER.tmp",
/// so that several hosts may write into one folder.
std::string temporaryName();

enum class Below { No, Yes };

/// Removes the temporary files and folders in a folder, and on demand in the folders below, that processes left when
/// they were killed while writing. Those of other processes that still run and of other hosts stay, and so does what cannot
/// be removed.
void removeTemporaries(const std::filesystem::path& folder, Below below = Below::Yes);

}  // namespace ulam
