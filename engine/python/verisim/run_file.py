"""A run file, its fields read when they are first used."""
import json
import os

from ._verisim import Failure, RunFile
from .values import path_of, shown


class Run:
    """run["/state/body/pin/pose"] is an array with a row per frame; run.fields says what there is.

    attributes, summary: what stands beside the fields. figures, warnings, error: of a run that verisim.run() made.
    """

    def __init__(self, path, figures=None, warnings=(), error=""):
        self._file = RunFile(path_of("path", path))
        self._read = {}
        self.fields = {field.path: field for field in self._file.fields()}
        try:
            self.attributes, self.summary = self._file.attributes, self._file.summary
        except UnicodeDecodeError as error:
            raise Failure(f"{self.path}: a text in it is no UTF-8; the file is damaged, simulate again") from error
        self.figures = figures
        self.warnings = list(warnings)
        self.error = error

    path = property(lambda self: self._file.path)
    frames = property(lambda self: self._file.frames)
    events = property(lambda self: self._file.events(), doc="time [s], kind and text of each")
    pairs = property(lambda self: self._file.pairs(), doc="of bodies that met; /state/links/pair counts them from 0")

    @property
    def parameters(self):
        """Of the scenario, as resolved."""
        try:
            return json.loads(self.attributes["parameters"])
        except (KeyError, ValueError) as error:
            raise Failure(f"{self.path}: its parameters cannot be read; the file is damaged, simulate again") from error

    def __getitem__(self, path):
        if not isinstance(path, str):
            raise Failure(f"{shown(path)} is no name of a field; give a text: run['state/time']")
        path = "/" + path.lstrip("/")
        if path not in self._read:
            self._read[path] = self._file.read(path)
        return self._read[path]

    def __iter__(self):
        return iter(self.fields)

    def __len__(self):
        return len(self.fields)

    def __contains__(self, path):
        return "/" + path.lstrip("/") in self.fields

    def __repr__(self):
        return f"<verisim.Run {self.path}: {self.frames} frames, {len(self.fields)} fields>"

    def to_pandas(self, paths=None):
        """A DataFrame with a row per frame; a column per number, named "state/body/pin/pose.0". attrs["units"] has their
        units. Fields that have no row in every frame are left out: take them by name, or to_xarray()."""
        import pandas

        columns, units = {}, {}
        for path in self._paths(paths):
            field, values = self.fields[path], self[path]
            if not field.of_frames:
                if paths is not None:
                    raise ValueError(f"{path}: has no row in every frame")
                continue
            if field.width == 1:
                named = [(path.lstrip("/"), values)]
            else:
                named = [(f"{path.lstrip('/')}.{name}", values[:, i]) for i, name in enumerate(_components(field))]
            for name, column in named:
                columns[name], units[name] = column, field.units
        table = pandas.DataFrame(columns, index=pandas.Index(self["/state/time"], name="time"))
        table.attrs["units"] = units
        return table

    def to_xarray(self, paths=None):
        """A Dataset of all fields, with units and meanings; those of a folder that have no row in every frame share a
        dimension of their own."""
        import xarray

        variables, widths, coordinates = {}, {}, {"time": ("frame", self["/state/time"], {"units": "s"})}
        for path in self._paths(paths):
            field, name = self.fields[path], path.lstrip("/")
            dims = ["frame" if field.of_frames else os.path.dirname(name) + "/row"]
            if field.width > 1:
                component = os.path.basename(name)  # pose, wrench …: one dimension for all of one width
                dims.append(component if widths.setdefault(component, field.width) == field.width else f"{component}_{field.width}")
                if len(field.names) == field.width:
                    coordinates[dims[1]] = field.names
            variables[name] = (dims, self[path], {"units": field.units, "long_name": field.meaning})
        return xarray.Dataset(variables, coords=coordinates, attrs=self.attributes)

    def _paths(self, paths):
        if paths is None:
            return list(self.fields)
        paths = ["/" + path.lstrip("/") for path in ([paths] if isinstance(paths, str) else paths)]
        for path in paths:
            if path not in self.fields:
                self[path]  # Failure, with the names that are like it
        return paths


def _components(field):
    return field.names if len(field.names) == field.width else range(field.width)
