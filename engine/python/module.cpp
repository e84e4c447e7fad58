// The library's functions as Python sees them; engine/python/verisim/__init__.py gives them their Python form.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cstddef>
#include <memory>

#include <verisim/run.hpp>
#include <verisim/run_file.hpp>

namespace py = pybind11;

namespace {

/// A copy as a NumPy array that nobody can write to: it is kept for who asks for the field again.
py::array array_of(const verisim::Values& values) {
  py::array array(py::dtype(values.field.type), values.shape);
  std::copy(values.bytes.begin(), values.bytes.end(), static_cast<std::byte*>(array.mutable_data()));
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

/// A frame as long as its callback is called; a Failure for who has kept it longer.
class FrameInCallback {
 public:
  explicit FrameInCallback(const verisim::Frame& frame) : frame_(&frame) {}
  void end() { frame_ = nullptr; }
  [[nodiscard]] const verisim::Frame& get() const {
    if (frame_ == nullptr)
      throw verisim::Failure(2, "this frame is over: keep what it says (frame.pose(…)) instead of the frame");
    return *frame_;
  }

 private:
  const verisim::Frame* frame_;
};

template <auto Method>
auto of_frame() {
  return [](const FrameInCallback& frame) { return (frame.get().*Method)(); };
}
template <auto Method>
auto of_body() {
  return [](const FrameInCallback& frame, const py::object& body) {
    if (!py::isinstance<py::str>(body))
      throw verisim::Failure(2, std::string(py::repr(body)) + " is no body's name; give a text");
    return (frame.get().*Method)(body.cast<std::string>());
  };
}

/// Whether the run goes on.
bool ask(const py::object& each_frame, const verisim::Frame& frame) {
  const auto shown = std::make_shared<FrameInCallback>(frame);
  const auto ended = [](FrameInCallback* f) { f->end(); };
  const std::unique_ptr<FrameInCallback, decltype(ended)> end(shown.get(), ended);
  const py::object answer = each_frame(shown);
  if (answer.is_none()) return true;
  const int goes_on = PyObject_IsTrue(answer.ptr());
  if (goes_on < 0) throw py::error_already_set();
  return goes_on != 0;
}

/// Runs without Python's lock; what the scenario prints goes to sys.stderr, as the program's. Ctrl-C and what
/// `each_frame` throws end the run, and the file is closed.
verisim::RunOutcome run(verisim::RunRequest request, const py::object& each_frame) {
  constexpr std::uint64_t kLook = 64;  // frames between two looks for signals
  request.each_frame = [&](const verisim::Frame& frame) {
    if (each_frame.is_none() && frame.number() % kLook != 0) return true;
    const py::gil_scoped_acquire lock;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    return each_frame.is_none() || ask(each_frame, frame);
  };
  request.print = [](const std::string& line) {
    const py::gil_scoped_acquire lock;
    py::print(line, py::arg("file") = py::module_::import("sys").attr("stderr"));
  };
  const py::gil_scoped_release unlocked;
  return verisim::run(request);
}

}  // namespace

PYBIND11_MODULE(_verisim, module) {
  py::register_exception<verisim::Failure>(module, "Failure", PyExc_RuntimeError);
  module.def("version", &verisim::version);

  py::class_<FrameInCallback, std::shared_ptr<FrameInCallback>>(module, "Frame")
      .def_property_readonly("number", of_frame<&verisim::Frame::number>())
      .def_property_readonly("time", of_frame<&verisim::Frame::time>())
      .def_property_readonly("bodies", of_frame<&verisim::Frame::bodies>())
      .def("pose", of_body<&verisim::Frame::pose>())
      .def("velocity", of_body<&verisim::Frame::velocity>())
      .def("contact_wrench", of_body<&verisim::Frame::contact_wrench>());

  py::class_<verisim::RunRequest>(module, "RunRequest")
      .def(py::init<>())
      .def_readwrite("scenario", &verisim::RunRequest::scenario)
      .def_readwrite("parameters", &verisim::RunRequest::parameters)
      .def_readwrite("binds", &verisim::RunRequest::binds)
      .def_readwrite("seed", &verisim::RunRequest::seed)
      .def_readwrite("duration", &verisim::RunRequest::duration)
      .def_readwrite("out", &verisim::RunRequest::out)
      .def_readwrite("force", &verisim::RunRequest::force)
      .def_readwrite("another_name", &verisim::RunRequest::another_name)
      .def_readwrite("threads", &verisim::RunRequest::threads)
      .def_readwrite("prepared", &verisim::RunRequest::prepared);

  py::class_<verisim::RunOutcome>(module, "RunOutcome")
      .def_readonly("error", &verisim::RunOutcome::error)
      .def_readonly("warnings", &verisim::RunOutcome::warnings)
      .def_readonly("out", &verisim::RunOutcome::out)
      .def_readonly("json", &verisim::RunOutcome::json);
  module.def("run", &run);

  py::class_<verisim::Field>(module, "Field")
      .def_readonly("path", &verisim::Field::path)
      .def_readonly("type", &verisim::Field::type)
      .def_readonly("width", &verisim::Field::width)
      .def_readonly("units", &verisim::Field::units)
      .def_readonly("meaning", &verisim::Field::meaning)
      .def_readonly("names", &verisim::Field::names)
      .def_readonly("of_frames", &verisim::Field::of_frames);

  py::class_<verisim::RunEvent>(module, "Event")
      .def_readonly("time", &verisim::RunEvent::time)
      .def_readonly("kind", &verisim::RunEvent::kind)
      .def_readonly("text", &verisim::RunEvent::text);

  py::class_<verisim::Run>(module, "RunFile")
      .def(py::init<const std::string&>())
      .def_property_readonly("path", &verisim::Run::path)
      .def_property_readonly("frames", &verisim::Run::frames)
      .def_property_readonly("attributes", &verisim::Run::attributes)
      .def_property_readonly("summary", &verisim::Run::summary)
      .def("fields", &verisim::Run::fields)
      .def("events", &verisim::Run::events)
      .def("pairs", &verisim::Run::pairs)
      .def("read", [](const verisim::Run& run, const std::string& path) { return array_of(run.read(path)); });
}
