"""Messages of protobuf as records of numbers, by the schema that stands in the file beside them."""

from collections.abc import Mapping
from typing import Any

from fricomp.recording.sources.entry_names import NAMES_OF_ENTRIES, tell_entries_apart

_STAMP, _SPAN = "google.protobuf.Timestamp", "google.protobuf.Duration"


def read_stamped_message(message: Any) -> dict[str, Any]:
    """The numbers of a message of a log, with `time` [s] from its first `Timestamp`, or from that of its header.

    Args:
        message: Of a class that was built from the schema.
    """
    record, fields = _read_message(message), message.DESCRIPTOR.fields
    stamps = [record.get(one.name) for one in fields if _holds(one, _STAMP)]
    header = message.DESCRIPTOR.fields_by_name.get("header")
    if isinstance(record.get("header"), dict) and not header.is_repeated:
        stamps += [record["header"].get(one.name) for one in message.header.DESCRIPTOR.fields if _holds(one, _STAMP)]
    stamp = next((one for one in stamps if one), None)  # zero is what nobody has set
    return record if stamp is None else {"time": stamp, **record}


def _holds(field: Any, kind: str) -> bool:
    return field.message_type is not None and not field.is_repeated and field.message_type.full_name == kind


def _read_message(message: Any) -> dict[str, Any]:
    """The numbers of a decoded message, nested as it is.

    A time is in seconds. Lists beside a list of names, and messages that each have a `name`, are told apart by these
    names. Texts and bytes are left out, and so is a field that was not set, where the schema tells that.
    """
    record: dict[str, Any] = {}
    for field in message.DESCRIPTOR.fields:
        value = getattr(message, field.name)
        if field.has_presence and not message.HasField(field.name):
            continue
        found = _read_entries(field, value) if field.is_repeated else _read_value(field, value)
        if found is not None:
            record[field.name] = found
    return _name_entries(message, record)


def _read_entries(field: Any, value: Any) -> Any:
    if isinstance(value, Mapping):
        kind = field.message_type.fields_by_name["value"]
        return {str(key): _read_value(kind, one) for key, one in value.items()}
    if field.message_type is not None and "name" in field.message_type.fields_by_name:
        named = {str(one.name): _read_value(field, one) for one in value}
        if len(named) == len(value):
            return named
    entries = [_read_value(field, one) for one in value]
    return None if any(one is None for one in entries) else entries


def _read_value(field: Any, value: Any) -> Any:
    """A number, or the record of a message; None for a text or bytes."""
    if field.message_type is None:
        return value if isinstance(value, bool | int | float) else None
    if field.message_type.full_name in (_STAMP, _SPAN):
        return value.seconds + 1e-9 * value.nanos
    return _read_message(value)


def _name_entries(message: Any, record: dict[str, Any]) -> dict[str, Any]:
    """The record with lists of numbers told apart by the names that stand beside them: `<name>.<field>`."""
    fields = message.DESCRIPTOR.fields_by_name
    key = next((one for one in NAMES_OF_ENTRIES if one in fields and fields[one].is_repeated), None)
    names = [one for one in getattr(message, key) if isinstance(one, str)] if key is not None else []
    if not names:
        return record
    return tell_entries_apart({name: value for name, value in record.items() if value != []}, names)
