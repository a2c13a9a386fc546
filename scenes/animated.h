// Scenes that move: opened once, posed at any time.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scene.h"

namespace marti::scenes {

struct AnimationFacts {
  std::string name;            ///< may be empty
  double duration = 0.0;       ///< seconds, to the last key frame
  std::uint64_t channels = 0;  ///< number of node properties that it changes
};

/// The parts of a scene that can move.
struct MotionFacts {
  std::vector<AnimationFacts> animations;  ///< all animations of the file
  int chosen = -1;                         ///< the one that plays, -1 if none does
  std::uint64_t skins = 0;                 ///< used by meshes of the scene
  std::uint64_t morph_targets = 0;         ///< of the meshes of the scene
};

/// How many parts of one kind of a file a scene uses.
struct PartUse {
  std::string_view name;  ///< in the plural: "nodes"
  std::uint64_t all = 0;
  std::uint64_t used = 0;
};

/// How much of its file a scene uses.
struct FileUse {
  std::vector<PartUse> parts;      ///< empty for a scene that is not from a file
  std::uint64_t unread_bytes = 0;  ///< of the accessors and images that the scene does not use
};

/// The source of poses. Any number of threads may ask at once.
class PoseSource {
 public:
  PoseSource() = default;
  PoseSource(const PoseSource&) = delete;
  PoseSource& operator=(const PoseSource&) = delete;
  virtual ~PoseSource() = default;
  /// The pose at a finite time. See AnimatedScene::at.
  [[nodiscard]] virtual Scene at(double seconds) const = 0;
  /// False when there is only one pose.
  [[nodiscard]] virtual bool moves() const = 0;
  /// Seconds to the last key frame; 0 when there is only one pose.
  [[nodiscard]] virtual double duration() const = 0;
  [[nodiscard]] virtual MotionFacts facts() const = 0;
  [[nodiscard]] virtual FileUse file_use() const { return {}; }
};

/// A scene over time. Copies share their data.
///
/// All poses have the same triangles: the same number in the same order with the same materials and source
/// polygons, so that a primitive id means the same triangle in each. Only positions, normals, lights, camera
/// and notes differ, and the order of a triangle's corners where a node is mirrored in only one of two poses.
/// Parts that do not move have bit-identical positions.
class AnimatedScene {
 public:
  /// A scene of one pose, and how much of its file it uses.
  explicit AnimatedScene(Scene only, FileUse use = {});
  explicit AnimatedScene(std::shared_ptr<const PoseSource> source) : source_(std::move(source)) {}

  /// The pose at a time in seconds; times before the beginning or after the end of the animation give its
  /// first or last pose. The same time gives the same bits. A triangle with a corner that is not finite or
  /// beyond 1e30 in this pose shrinks to a point without area, so that all ids stay the same; a note says how
  /// many did. Throws UserError when the time is not finite, when no triangle has finite positions, and when
  /// a transform is not finite or leaves a light or the camera no direction.
  [[nodiscard]] Scene at(double seconds) const;

  /// at(), but with only one pose, a time other than 0 is an error, whose message begins with the scene's
  /// `name`.
  [[nodiscard]] Scene asked_for(double seconds, const std::string& name) const;

  /// Whether an animation plays. If not, there is only one pose.
  [[nodiscard]] bool moves() const { return source_->moves(); }

  /// Seconds to the last key frame; 0 when there is only one pose.
  [[nodiscard]] double duration() const { return source_->duration(); }

  /// Throws UserError when any animation of the file is broken, whether it plays or not.
  [[nodiscard]] MotionFacts facts() const { return source_->facts(); }

  [[nodiscard]] FileUse file_use() const { return source_->file_use(); }

 private:
  std::shared_ptr<const PoseSource> source_;
};

/// The primitives whose corners differ between two poses of one scene, compared bit for bit; ids, ascending.
/// Throws InternalError when the two differ in their number of triangles.
[[nodiscard]] std::vector<std::uint32_t> moved_primitives(const Scene& before, const Scene& after);

/// The facts as text, one "name: value" line each.
[[nodiscard]] std::string describe(const MotionFacts& facts);

}  // namespace marti::scenes
