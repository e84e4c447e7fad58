// STEP and BREP files in, STEP files out. An assembly is walked down from its free shapes; each solid takes the
// placement of all above it.
#include <APIHeaderSection_MakeHeader.hxx>
#include <BRepTools.hxx>
#include <BRep_Builder.hxx>
#include <IFSelect_ReturnStatus.hxx>
#include <Interface_Static.hxx>
#include <Message.hxx>
#include <Message_Messenger.hxx>
#include <Quantity_Color.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <STEPCAFControl_Writer.hxx>
#include <Standard_Failure.hxx>
#include <StepData_StepModel.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_ColorTool.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <XSControl_WorkSession.hxx>
#include <fstream>
#include <optional>

#include "engine/geometry/cad/shapes.hpp"

namespace verisim::cad {
namespace {

using Color = std::array<float, 4>;

/// Names that translators invent where the designer gave none.
bool is_invented(const std::string& name) {
  for (const char* kind : {"", "SOLID", "COMPOUND", "COMPSOLID", "SHELL", "NONE"}) {
    if (name == kind) return true;
  }
  return name.starts_with("=>[") || name.starts_with("Open CASCADE STEP translator");
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) name;
  if (!label.FindAttribute(TDataStd_Name::GetID(), name)) return {};
  const TCollection_AsciiString utf8(name->Get());
  return utf8.ToCString();
}

Color color_from(const Quantity_Color& kernel) {
  Standard_Real r = 0;
  Standard_Real g = 0;
  Standard_Real b = 0;
  kernel.Values(r, g, b, Quantity_TOC_sRGB);  // as the file has them
  return {static_cast<float>(r), static_cast<float>(g), static_cast<float>(b), 1};
}

class AssemblyWalk {
 public:
  explicit AssemblyWalk(const Handle(TDocStd_Document) & document)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())),
        colors_(XCAFDoc_DocumentTool::ColorTool(document->Main())) {}

  std::vector<NamedShape> solids() {
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) visit(root, TopLoc_Location(), {}, std::nullopt);
    return std::move(found_);
  }

 private:
  void visit(const TDF_Label& label, const TopLoc_Location& above, std::string name, std::optional<Color> color) {
    TDF_Label product = label;
    TopLoc_Location here = above;
    if (XCAFDoc_ShapeTool::IsReference(label)) {
      XCAFDoc_ShapeTool::GetReferredShape(label, product);
      here = above * XCAFDoc_ShapeTool::GetLocation(label);
    }
    if (const std::string own = name_of(product); !is_invented(own)) name = own;
    for (const TDF_Label& named : {product, label}) {  // what an instance says goes before what its product says
      if (const auto own = color_of(named)) color = own;
    }
    if (XCAFDoc_ShapeTool::IsAssembly(product)) {
      TDF_LabelSequence components;
      XCAFDoc_ShapeTool::GetComponents(product, components);
      for (const TDF_Label& component : components) visit(component, here, name, color);
      return;
    }
    for (TopExp_Explorer e(XCAFDoc_ShapeTool::GetShape(product), TopAbs_SOLID); e.More(); e.Next()) {
      add(product, e.Current(), here, name, color);
    }
  }

  void add(const TDF_Label& product, const TopoDS_Shape& solid, const TopLoc_Location& placement, std::string name,
           std::optional<Color> color) {
    TDF_Label own;
    if (shapes_->FindSubShape(product, solid, own)) {
      if (const std::string own_name = name_of(own); !is_invented(own_name)) name = own_name;
      if (const auto own_color = color_of(own)) color = own_color;
    }
    NamedShape named;
    named.shape = solid.Moved(placement);
    named.name = name;
    if (color) named.color = *color;
    found_.push_back(std::move(named));
  }

  std::optional<Color> color_of(const TDF_Label& label) {
    Quantity_Color color;
    for (const XCAFDoc_ColorType type : {XCAFDoc_ColorSurf, XCAFDoc_ColorGen}) {
      if (colors_->GetColor(label, type, color)) return color_from(color);
    }
    return std::nullopt;
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  Handle(XCAFDoc_ColorTool) colors_;
  std::vector<NamedShape> found_;
};

bool has_a_face(const TopoDS_Shape& shape) {
  return TopExp_Explorer(shape, TopAbs_FACE).More();
}

std::vector<Part> parts_from(std::vector<NamedShape> solids, const Options& options) {
  const std::size_t empty = std::erase_if(solids, [](const NamedShape& s) { return !has_a_face(s.shape); });
  if (solids.empty()) {
    fail(ErrorKind::input, "{}: there is no solid in it; export solids, not surfaces, sketches or meshes",
         options.path);
  }
  if (empty > 0)
    solids.front().notes.push_back(fmt::format("{} solid(s) of its file are empty and were left out", empty));
  std::vector<Part> parts;
  for (const NamedShape& solid : solids) parts.push_back(part_from(solid, options));
  return parts;
}

Handle(TDocStd_Document) new_document() {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  return document;
}

}  // namespace

void initialize() {
  ::Message::DefaultMessenger()->ChangePrinters().Clear();
  Interface_Static::SetIVal("read.stepcaf.subshapes.name", 1);
}

std::string describe_exception() {
  try {
    throw;
  } catch (const Standard_Failure& failure) {
    return fmt::format("{} {}", failure.DynamicType()->Name(), failure.GetMessageString());
  } catch (...) {
    return {};
  }
}

std::vector<Part> read_step(const std::string& content_path, const Options& options) {
  STEPCAFControl_Reader reader;
  reader.SetNameMode(Standard_True);
  reader.SetColorMode(Standard_True);
  reader.SetLayerMode(Standard_False);
  reader.SetPropsMode(Standard_False);
  if (reader.ReadFile(content_path.c_str()) != IFSelect_RetDone) {
    fail(ErrorKind::input, "{}: this is no STEP file that can be read; export it again as AP203, AP214 or AP242",
         options.path);
  }
  Handle(TDocStd_Document) document = new_document();
  if (!reader.Transfer(document)) {
    fail(ErrorKind::input, "{}: its shapes cannot be read; it is damaged or holds none, export it again", options.path);
  }
  return parts_from(AssemblyWalk(document).solids(), options);
}

std::vector<Part> read_brep(const std::string& content_path, const Options& options) {
  std::ifstream content(content_path);
  TopoDS_Shape shape;
  BRepTools::Read(shape, content, BRep_Builder());
  if (shape.IsNull()) fail(ErrorKind::input, "{}: this is no BREP file that can be read; write it again", options.path);
  std::vector<NamedShape> solids;
  for (TopExp_Explorer e(shape, TopAbs_SOLID); e.More(); e.Next()) {
    NamedShape named;
    named.shape = e.Current();
    solids.push_back(std::move(named));
  }
  return parts_from(std::move(solids), options);
}

void write_step(const std::string& target_path, const std::vector<std::pair<std::string, Solid>>& solids) {
  Handle(TDocStd_Document) document = new_document();
  const Handle(XCAFDoc_ShapeTool) shapes = XCAFDoc_DocumentTool::ShapeTool(document->Main());
  for (const auto& [name, solid] : solids) {
    TDataStd_Name::Set(shapes->AddShape(shape_from(solid), /*makeAssembly=*/Standard_False),
                       TCollection_ExtendedString(name.c_str(), /*isMultiByte=*/Standard_True));
  }
  STEPCAFControl_Writer writer;
  Interface_Static::SetCVal("write.step.schema", "AP214IS");
  Interface_Static::SetCVal("write.step.unit", "MM");
  if (!writer.Transfer(document))
    fail(ErrorKind::input, "the CAD kernel cannot write the solids; load them first to see why");
  // The same solids give the same file, whenever it is written.
  APIHeaderSection_MakeHeader header(Handle(StepData_StepModel)::DownCast(writer.ChangeWriter().WS()->Model()));
  header.SetTimeStamp(new TCollection_HAsciiString("1970-01-01T00:00:00"));
  if (writer.Write(target_path.c_str()) != IFSelect_RetDone) {
    fail(ErrorKind::io, "the STEP text cannot be written; is memory left?");
  }
}

}  // namespace verisim::cad
