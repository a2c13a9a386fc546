#ifdef MARTI_DRACO

#include "scenes/draco_mesh.h"

#include <cmath>
#include <utility>

#include <draco/compression/config/decoder_options.h>
#include <draco/compression/mesh/mesh_edgebreaker_decoder.h>
#include <draco/compression/mesh/mesh_sequential_decoder.h>
#include <draco/core/decoder_buffer.h>
#include <draco/core/varint_decoding.h>

#include "sim/shown.h"

namespace marti::scenes {

namespace {

/// The oldest version of compressed data that the extension allows: 2.2.
constexpr std::uint16_t oldest_version = DRACO_BITSTREAM_VERSION(2, 2);

/// A decoder of Draco that stops where the data would take more than expected: the library itself allocates
/// what they declare.
template <class Decoder, bool vertices_first>
class Limited : public Decoder {
 public:
  explicit Limited(const DracoCounts& expected) : expected_(expected) {}
  [[nodiscard]] const std::string& refusal() const { return refusal_; }

 protected:
  // The data begin with the number of faces, and that of points before or after it.
  bool DecodeConnectivity() override {
    draco::DecoderBuffer ahead = *this->buffer();
    std::uint32_t first = 0;
    std::uint32_t second = 0;
    if (this->bitstream_version() < oldest_version) {
      refusal_ = "are of a version before 2.2, which glTF does not allow";
      return false;
    }
    if (!draco::DecodeVarint(&first, &ahead) || !draco::DecodeVarint(&second, &ahead)) {
      return false;
    }
    const std::uint32_t faces = vertices_first ? second : first;
    if (faces != expected_.faces) {
      refusal_ = "have " + std::to_string(faces) + " triangles, but the accessor of its indices is for " +
                 std::to_string(expected_.faces);
      return false;
    }
    return Decoder::DecodeConnectivity();
  }

  // Called when the attributes are known and nothing is allocated for them.
  bool DecodeAllAttributes() override {
    const std::uint64_t points = this->point_cloud()->num_points();
    if (points != expected_.points) {
      refusal_ = "have " + std::to_string(points) + " vertices, but the accessors of its attributes have " +
                 std::to_string(expected_.points);
      return false;
    }
    std::uint64_t bytes = 0;
    for (int i = 0; i < this->point_cloud()->num_attributes(); ++i) {
      const draco::PointAttribute* const attribute = this->point_cloud()->attribute(i);
      // The values, and the integers of 32 bits that are quantized ones; whatever stride is declared.
      bytes += points *
               (static_cast<std::uint64_t>(std::abs(attribute->byte_stride())) +
                4U * static_cast<std::uint64_t>(static_cast<std::uint8_t>(attribute->num_components())) + 8U);
    }
    if (bytes > expected_.memory) {
      refusal_ = "would take " + std::to_string(bytes) + " bytes, more than the " +
                 std::to_string(expected_.memory) + " that are accepted for it";
      return false;
    }
    return Decoder::DecodeAllAttributes();
  }

 private:
  DracoCounts expected_;
  std::string refusal_;
};

template <class Decoder>
std::unique_ptr<draco::Mesh> decode_with(Decoder decoder, draco::DecoderBuffer& buffer,
                                         std::string& refusal) {
  auto mesh = std::make_unique<draco::Mesh>();
  const draco::Status status = decoder.Decode(draco::DecoderOptions(), &buffer, mesh.get());
  refusal = decoder.refusal();
  if (refusal.empty() && !status.ok()) {
    refusal = "are damaged: '" + sim::shown(status.error_msg_string()) + "'";
  }
  return refusal.empty() ? std::move(mesh) : nullptr;
}

}  // namespace

std::unique_ptr<draco::Mesh> decode_draco(std::span<const std::byte> bytes, const DracoCounts& expected,
                                          std::string& refusal) {
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  draco::DecoderBuffer ahead = buffer;
  draco::DracoHeader header{};
  std::unique_ptr<draco::Mesh> mesh;
  if (!draco::PointCloudDecoder::DecodeHeader(&ahead, &header).ok()) {
    refusal = "do not begin as Draco's do";
  } else if (header.encoder_type != draco::TRIANGULAR_MESH) {
    refusal = "are no mesh";
  } else if (header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING) {
    mesh = decode_with(Limited<draco::MeshSequentialDecoder, false>(expected), buffer, refusal);
  } else if (header.encoder_method == draco::MESH_EDGEBREAKER_ENCODING) {
    mesh = decode_with(Limited<draco::MeshEdgebreakerDecoder, true>(expected), buffer, refusal);
  } else {
    refusal = "are encoded by an unknown method, " + std::to_string(header.encoder_method);
  }
  if (mesh != nullptr && (mesh->num_faces() != expected.faces || mesh->num_points() != expected.points)) {
    refusal = "are damaged: they have " + std::to_string(mesh->num_faces()) + " triangles and " +
              std::to_string(mesh->num_points()) + " vertices";
    mesh = nullptr;
  }
  return mesh;
}

}  // namespace marti::scenes

#endif
