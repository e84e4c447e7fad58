#include "engine/voxel/association.hpp"

#include <algorithm>
#include <memory>

#include "engine/base/error.hpp"
#include "engine/voxel/edge_cells.hpp"
#include "engine/voxel/limits.hpp"
#include "engine/voxel/parallel.hpp"
#include "engine/voxel/prepared_faces.hpp"
#include "engine/voxel/slot_sets.hpp"
#include "engine/voxel/surface.hpp"
#include "engine/voxel/voxelize.hpp"

namespace verisim {

namespace {

BrickMask common(const BrickMask& a, const BrickMask& b) {
  BrickMask result;
  for (std::size_t z = 0; z < result.size(); ++z) result[z] = a[z] & b[z];
  return result;
}

BrickMask without(const BrickMask& a, const BrickMask& b) {
  BrickMask result;
  for (std::size_t z = 0; z < result.size(); ++z) result[z] = a[z] & ~b[z];
  return result;
}

void mark(BrickMask& mask, int x, int y, int z) {
  mask[static_cast<std::size_t>(z)] |= std::uint64_t{1} << (x + 8 * y);
}

/// The bricks that hold surface voxels, in the order in which these are numbered.
struct SurfaceBricks {
  explicit SurfaceBricks(const Voxmap& map) : entry(map.brick_block.size(), kNoSurface) {
    for (std::size_t i = 0; i < map.brick_block.size(); ++i) {
      if (map.brick_block[i] <= kInsideBlock || !any(map.surface_mask[map.brick_block[i]])) continue;
      entry[i] = static_cast<std::uint32_t>(brick.size());
      brick.push_back(static_cast<std::uint32_t>(i));
    }
  }
  std::vector<std::uint32_t> brick;
  std::vector<std::uint32_t> entry;
};

/// Data that all bricks read.
struct Model {
  Model(const Part& the_part, const Voxmap& the_map)
      : part(the_part),
        map(the_map),
        bricks(map),
        mesh(in_grid_coordinates(part.mesh, map)),
        faces(prepare_faces(part, mesh, map)),
        lists(list_triangles_by_brick(mesh, map.bricks, largest_deflection())),
        curves(grid_curves()),
        edges(curves, nearness_of_edges(), map.bricks, bricks.entry, bricks.brick.size()) {}

  [[nodiscard]] double largest_deflection() const {
    double largest = kCandidateMargin;
    for (const PreparedFace& face : faces) largest = std::max(largest, face.deflection);
    return largest;
  }
  [[nodiscard]] std::vector<GridCurve> grid_curves() const {
    std::vector<GridCurve> result;
    result.reserve(part.edges.size());
    for (const Edge& edge : part.edges) {
      result.emplace_back(edge, Matrix3d::Identity(), map.origin, 1 / map.voxel_size);
    }
    return result;
  }
  [[nodiscard]] std::vector<double> nearness_of_edges() const {
    std::vector<double> result(part.edges.size(), 0);
    for (std::size_t e = 0; e < result.size(); ++e) {
      for (const std::uint32_t f : part.edges[e].faces) result[e] = std::max(result[e], faces[f].nearness);
    }
    return result;
  }

  const Part& part;
  const Voxmap& map;
  SurfaceBricks bricks;
  GridMesh mesh;
  std::vector<PreparedFace> faces;
  BrickLists lists;
  std::vector<GridCurve> curves;  // of the edges
  EdgeLists edges;
};

/// The sets of a chunk of bricks: those of each brick in the order of its voxels, each once per brick.
struct SetsOfChunk {
  std::vector<EntityNumber> entities;
  std::vector<std::uint32_t> set_end;    // where each set ends in `entities`
  std::vector<std::uint32_t> brick_end;  // where each brick's sets end in `set_end`
  std::uint32_t stand_ins = 0, without = 0;
};

/// One brick after the other; keeps its buffers.
class BrickAssociation {
 public:
  BrickAssociation(const Model& model, EntityNumber first_edge, SetsOfChunk& run)
      : model_(model), first_edge_(first_edge), run_(run) {}

  /// Writes for each surface voxel of the brick 0, or 1 + the index of its set among the brick's sets.
  void associate(std::size_t entry, FeatureSetId* features) {
    const std::size_t brick = model_.bricks.brick[entry];
    corner_ = brick_corner(brick, model_.map.bricks);
    cells_ = model_.map.surface_mask[model_.map.brick_block[brick]];
    triangles_ = model_.lists.of(brick);
    find_edges(entry);
    find_faces(entry);
    write_sets(features);
  }

 private:
  /// An entity and the voxels of the brick that it passes through.
  struct Passing {
    EntityNumber entity;
    BrickMask cells;
  };
  /// A face with triangles near the brick.
  struct NearFace {
    std::uint32_t face;
    BrickMask near;  // voxels that its triangles, grown by its deflection, touch
  };

  [[nodiscard]] GridBox box_of(int x, int y, int z) const {
    return {(corner_ + Eigen::Vector3i(x, y, z)).cast<double>() + Vector3d::Constant(0.5), kBoxHalf};
  }

  void find_edges(std::size_t entry) {
    passing_edges_.clear();
    for (const EdgeCells& near : model_.edges.of(entry)) {
      BrickMask passed{};
      for_each_cell(common(near.candidates, cells_), [&](int x, int y, int z) {
        if (model_.curves[near.edge].passes(box_of(x, y, z))) mark(passed, x, y, z);
      });
      passing_edges_.push_back({near.edge, passed});
    }
  }

  /// Voxels that a face's triangles touch when both are grown by its deflection; or the voxels themselves.
  [[nodiscard]] BrickMask touched(std::uint32_t triangle, double growth) const {
    const auto [a, b, c] = model_.mesh.corners(triangle);
    return TriangleOverlap(a, b, c).touched(
        {.corner = corner_.cast<double>(), .side = 1, .half_side = kBoxHalf + growth});
  }

  void find_near_faces() {
    near_faces_.clear();
    for (const std::uint32_t t : triangles_) {
      const std::uint32_t face = model_.part.mesh.face_of_triangle[t];
      if (face == kNoFace) continue;
      auto known = std::ranges::find(near_faces_.rbegin(), near_faces_.rend(), face, &NearFace::face);
      if (known == near_faces_.rend()) {
        near_faces_.push_back({face, BrickMask{}});
        known = near_faces_.rbegin();
      }
      if (!any(without(cells_, known->near))) continue;
      const PreparedFace& prepared = model_.faces[face];
      add(known->near, touched(t, prepared.trim ? prepared.deflection : 0));
    }
    std::ranges::sort(near_faces_, {}, &NearFace::face);
  }

  void find_faces(std::size_t entry) {
    find_near_faces();
    passing_.clear();
    const std::span<const EdgeCells> edges = model_.edges.of(entry);
    for (const NearFace& candidate : near_faces_) {
      // A face passes wherever one of its edges does.
      BrickMask by_edges{}, near_bounds{};
      for (std::size_t i = 0; i < edges.size(); ++i) {
        const std::vector<std::uint32_t>& of = model_.part.edges[edges[i].edge].faces;
        if (std::ranges::find(of, candidate.face) == of.end()) continue;
        add(by_edges, passing_edges_[i].cells);
        if (of.size() > 1) add(near_bounds, edges[i].near);
      }
      BrickMask cells = common(by_edges, cells_);
      const BrickMask open = without(common(candidate.near, cells_), cells);
      const PreparedFace& face = model_.faces[candidate.face];
      if (!face.trim) {
        add(cells, open);
      } else {
        for_each_cell(open, [&](int x, int y, int z) {
          const GridBox box = box_of(x, y, z);
          if (!face.surface->touches(box)) return;
          const bool is_inner =
              !contains(near_bounds, x, y, z) && face.surface->is_one_sheet(box.center, face.nearness);
          if (is_inner || passes_within_bounds(face, candidate.face, box)) mark(cells, x, y, z);
        });
      }
      if (any(cells)) passing_.push_back({candidate.face, cells});
    }
    for (const Passing& edge : passing_edges_) {
      if (any(edge.cells)) passing_.push_back({first_edge_ + edge.entity, edge.cells});
    }
  }

  /// No bound passes through the box, so each piece of the surface in it is either within the face or outside.
  bool passes_within_bounds(const PreparedFace& face, std::uint32_t number, const GridBox& box) {
    probes_.clear();
    face.surface->add_probes(box, probes_);
    for (const Vector3d& probe : probes_) {
      const std::optional<bool> within = face.trim->contains(probe);
      if (within ? *within : triangles_touch(number, box)) return true;
    }
    return false;
  }

  [[nodiscard]] bool triangles_touch(std::uint32_t face, const GridBox& box) const {
    return std::ranges::any_of(triangles_, [&](std::uint32_t t) {
      if (model_.part.mesh.face_of_triangle[t] != face) return false;
      const auto [a, b, c] = model_.mesh.corners(t);
      return triangle_touches_box(a, b, c, box.center, 0.5);
    });
  }

  void write_sets(FeatureSetId* features) {
    const std::size_t first = run_.set_end.size();
    const auto begin_of = [&](std::size_t set) { return set == 0 ? 0 : run_.set_end[set - 1]; };
    std::size_t last = first;  // the set of the last voxel, most likely that of the next
    for_each_cell(cells_, [&](int x, int y, int z) {
      set_.clear();
      for (const Passing& passing : passing_) {
        if (contains(passing.cells, x, y, z)) set_.push_back(passing.entity);
      }
      if (set_.empty()) stand_in(box_of(x, y, z));
      if (set_.empty()) {
        *features++ = 0;
        return;
      }
      const auto is_this = [&](std::size_t set) {
        return std::ranges::equal(set_,
                                  std::span(run_.entities).subspan(begin_of(set), run_.set_end[set] - begin_of(set)));
      };
      std::size_t place = last;
      if (place >= run_.set_end.size() || !is_this(place)) {
        place = first;
        while (place < run_.set_end.size() && !is_this(place)) ++place;
      }
      if (place == run_.set_end.size()) {
        run_.entities.insert(run_.entities.end(), set_.begin(), set_.end());
        run_.set_end.push_back(static_cast<std::uint32_t>(run_.entities.size()));
      }
      last = place;
      *features++ = static_cast<FeatureSetId>(1 + place - first);
    });
    run_.brick_end.push_back(static_cast<std::uint32_t>(run_.set_end.size()));
  }

  /// Only triangles pass through the voxel: their faces stand in.
  void stand_in(const GridBox& box) {
    for (const NearFace& face : near_faces_) {
      if (triangles_touch(face.face, box)) set_.push_back(face.face);
    }
    ++(set_.empty() ? run_.without : run_.stand_ins);
  }

  const Model& model_;
  EntityNumber first_edge_;  // number of the part's first edge
  SetsOfChunk& run_;
  Eigen::Vector3i corner_ = {0, 0, 0};
  BrickMask cells_{};  // the brick's surface voxels
  std::span<const std::uint32_t> triangles_;
  std::vector<Passing> passing_edges_;  // as the model's edges of the brick
  std::vector<NearFace> near_faces_;    // ascending
  std::vector<Passing> passing_;        // ascending
  std::vector<Vector3d> probes_;
  std::vector<EntityNumber> set_;
};

/// Numbers the sets of all chunks in the order of the voxels.
void number_sets(const std::vector<std::unique_ptr<SetsOfChunk>>& chunks, const Model& model, VoxelBody& body) {
  const Voxmap& map = body.voxmap;
  std::size_t entry = 0;
  for (const auto& run : chunks) {
    if (!run) continue;
    std::uint32_t set = 0, begin = 0;
    for (const std::uint32_t end : run->brick_end) {
      std::array<FeatureSetId, kBrickCells + 1> number{};
      for (std::size_t i = 1; set < end; ++set, ++i) {
        const std::span<const EntityNumber> entities(run->entities.data() + begin, run->set_end[set] - begin);
        number[i] = body.features.sets.intern(entities);
        begin = run->set_end[set];
      }
      const std::uint32_t block = map.brick_block[model.bricks.brick[entry++]];
      const auto first = body.shell.features.begin() + map.first_surface[block][0];
      for (auto id = first; id != first + count(map.surface_mask[block]); ++id) *id = number[*id];
    }
  }
}

/// Is the map of this mesh? One that voxelize() makes has the origin and the size that the mesh's bounds give it.
bool is_of(const Voxmap& map, const std::string& name, const TriangleMesh& mesh) {
  Eigen::Vector3i bricks;
  return grid_origin(checked_bounds(name, mesh), map.voxel_size, bricks) == map.origin && bricks == map.bricks;
}

/// The faces and edges of the part and those declared, and the sets of the latter.
BodyFeatures entities_of(const std::string& name, const Part& part, const AssociateOptions& options) {
  BodyFeatures features{part.faces, part.edges, FeatureSets(name, options.most_sets)};
  if (options.declared == nullptr) return features;
  const DeclaredFeatures& declared = *options.declared;
  features.faces.insert(features.faces.end(), declared.faces().begin(), declared.faces().end());
  features.edges.insert(features.edges.end(), declared.edges().begin(), declared.edges().end());
  for (std::size_t id = 1; id <= declared.size(); ++id) {
    const std::vector<EntityNumber> set =
        declared.numbered(static_cast<FeatureSetId>(id), static_cast<EntityNumber>(part.faces.size()),
                          static_cast<EntityNumber>(features.faces.size() + part.edges.size()));
    const FeatureSetId number = features.sets.intern(set);
    VERISIM_ASSERT(number == id);
  }
  return features;
}

AssociationReport associate_part(const Part& part, unsigned threads, VoxelBody& body) {
  VERISIM_ASSERT(part.mesh.face_of_triangle.size() == part.mesh.triangles.size());
  const Model model(part, body.voxmap);
  const auto first_edge = static_cast<EntityNumber>(body.features.faces.size());
  const std::size_t bricks = model.bricks.brick.size();
  std::vector<std::unique_ptr<SetsOfChunk>> chunks(bricks);  // each at the index of its first brick
  for_each_chunk(bricks, threads, [&](std::size_t begin, std::size_t end) {
    if (begin == end) return;
    chunks[begin] = std::make_unique<SetsOfChunk>();
    BrickAssociation association(model, first_edge, *chunks[begin]);
    for (std::size_t entry = begin; entry < end; ++entry) {
      const std::uint32_t block = body.voxmap.brick_block[model.bricks.brick[entry]];
      association.associate(entry, body.shell.features.data() + body.voxmap.first_surface[block][0]);
    }
  });
  number_sets(chunks, model, body);
  AssociationReport report;
  for (const auto& run : chunks) {
    if (!run) continue;
    report.stand_ins += run->stand_ins;
    report.without += run->without;
  }
  for (const PreparedFace& face : model.faces) report.loose_faces += face.is_loose ? 1 : 0;
  return report;
}

}  // namespace

AssociationReport associate(const std::string& name, const Part& part, const AssociateOptions& options,
                            VoxelBody& body) {
  VERISIM_ASSERT(body.voxmap.surface_count > 0);
  VERISIM_ASSERT(is_whole(part.mesh));
  VERISIM_ASSERT(is_of(body.voxmap, name, part.mesh));
  for (const Face& face : part.faces) {
    for (const std::uint32_t edge : face.edges) VERISIM_ASSERT(edge < part.edges.size());
  }
  for (const Edge& edge : part.edges) {
    for (const std::uint32_t face : edge.faces) VERISIM_ASSERT(face < part.faces.size());
  }
  body.features = entities_of(name, part, options);
  body.shell.features.assign(body.voxmap.surface_count, 0);
  const AssociationReport report = part.has_brep() ? associate_part(part, options.threads, body)
                                                   : AssociationReport{.without = body.voxmap.surface_count};
  if (options.declared != nullptr && !options.declared->of_voxel().empty()) {
    const std::vector<FeatureSetId>& declared = options.declared->of_voxel();
    VERISIM_ASSERT(declared.size() == body.shell.features.size());
    for (std::size_t i = 0; i < declared.size(); ++i) {
      if (declared[i] != 0) body.shell.features[i] = declared[i];
    }
  }
  body.slot_sets = sets_by_slot(body.voxmap, body.shell.features, body.features.sets, options.threads);
  return report;
}

}  // namespace verisim
