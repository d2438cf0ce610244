#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace glowworm {

/// Where a conversion keeps what its stages made until its output is there: `cave.svo.work` beside
/// cave.svo, or a folder in --temp-dir whose name is made from the output's path. One run at a time
/// holds it; runs that only read scans for it (kShared) may hold it together.
class WorkFolder {
  public:
    enum class Hold { kAlone, kShared };

    /// Makes the folder where it is not there, and clears away the unfinished files of killed runs.
    /// Throws Error: kExists where another run holds it or where it is not a work folder,
    /// kUnreadable where it cannot be made.
    WorkFolder(const std::filesystem::path& output, const std::filesystem::path& temp_dir,
               Hold hold = Hold::kAlone);

    /// Lets go. A folder in which nothing is kept is removed.
    ~WorkFolder();
    WorkFolder(const WorkFolder&) = delete;
    WorkFolder& operator=(const WorkFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }

    /// What the stage `name` keeps.
    std::filesystem::path part(const std::string& name) const { return path_ / (name + ".part"); }

    /// The names of all parts that are kept, in their order.
    std::vector<std::string> parts() const;

    bool keeps_anything() const { return !parts().empty(); }

    /// Removes the folder and what is kept in it.
    void remove() const;

  private:
    std::filesystem::path path_;
    int lock_ = -1;
};

/// The work folder of `output`, whether it is there or not.
std::filesystem::path work_folder_of(const std::filesystem::path& output,
                                     const std::filesystem::path& temp_dir);

/// Removes the unfinished files that killed runs left beside `output` under its temporary names.
void remove_abandoned(const std::filesystem::path& output);

}  // namespace glowworm
