#include "engine/exact/body_bytes.hpp"

#include "engine/base/archive.hpp"

namespace verisim::exact {
// Found by archive.hpp, by the types' namespace.

void fields(auto& archive, BodyOptions& options) {
  auto& [spacing, line, point, smooth, group, cells, pole, sagitta, beyond, corner, same] = options;
  archive(spacing, line, point, smooth, group, cells, pole, sagitta, beyond, corner, same);
}
void fields(auto& archive, ExactEdge::Mark& mark) {
  archive(mark.point, mark.outward);
}
void fields(auto& archive, ExactEdge& edge) {
  auto& [faces, convexity, extent, center, direction, across, half, beyond, corner, limits, sharp, has_sharp, ends,
         marks, bounds] = edge;
  archive(faces, convexity, extent, center, direction, across, half, beyond, corner, limits, sharp, has_sharp, ends,
          marks, bounds.min, bounds.max);
}
void fields(auto& archive, ExactFace& face) {
  archive(face.surface, face.trim, face.bounds.min, face.bounds.max);
}
void fields(auto& archive, Feature& feature) {
  auto& [kind, origin, x, y, radius, slope, width, length, stiffness, group, face, round, closed, begin, end] = feature;
  archive(kind, origin, x, y, radius, slope, width, length, stiffness, group, face, round, closed, begin, end);
}
void fields(auto& archive, SampleBlock& block) {
  archive(block.feature, block.begin, block.end);
}
void fields(auto& archive, BoxTree::Node& node) {
  archive(node.center, node.half, node.left, node.right);
}
void fields(auto& archive, BoxTree& tree) {
  archive(tree.nodes, tree.leaves);
}
void fields(auto& archive, ExactBody& body) {
  archive(body.options, body.faces, body.edges, body.features, body.sample_c, body.sample_s, body.cone_begin,
          body.cone_directions, body.blocks, body.face_tree, body.edge_tree, body.block_tree, body.precise_face_count);
}

std::string to_bytes(const ExactBody& body) {
  ArchiveWriter writer;
  writer(body);
  return std::move(writer.bytes);
}

ExactBody exact_body_from(std::string_view bytes) {
  ArchiveReader reader(bytes);
  ExactBody body;
  reader(body);
  if (!reader.is_at_end()) fail(ErrorKind::input, "an exact body goes on behind its end");
  return body;
}

}  // namespace verisim::exact
