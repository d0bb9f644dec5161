"""Topics, their types and the texts of an MCAP file: of several copies, the one to believe."""

from __future__ import annotations

from typing import TypeVar

from mcap.opcode import Opcode
from mcap.records import Channel, Metadata, Schema

from sonar_tracking.bags.mcap.mcap_scan import McapScan
from sonar_tracking.bags.mcap.mcap_summary import McapSummary, check_content, parsed

Record = TypeVar("Record", Schema, Channel)


class Descriptions:
    """Fills schemas, channels and metadata of a scan.

    The first copy that has a checksum counts; where none has one, the first of all.

    Parameters
    ----------
    scan : McapScan
        To be filled.
    summary : McapSummary
        What the closing part of the file says, which has a checksum.
    """

    def __init__(self, scan: McapScan, summary: McapSummary) -> None:
        self._scan = scan
        scan.schemas.update(summary.schemas)
        scan.channels.update(summary.channels)
        self._verified: set[tuple[type, int]] = {(Schema, number) for number in scan.schemas}
        self._verified |= {(Channel, number) for number in scan.channels}

    def take(self, opcode: int, content: bytes, verified: bool) -> None:
        """Take the content of a record; ``verified`` if a checksum speaks for it.

        Raises
        ------
        ValueError
            If it is damaged, or contradicts a copy that is not.
        """
        if opcode == Opcode.SCHEMA:
            self._keep(self._scan.schemas, parsed(Schema, content), verified)
        elif opcode == Opcode.CHANNEL:
            self._keep(self._scan.channels, parsed(Channel, content), verified)
        elif opcode == Opcode.METADATA:
            record = parsed(Metadata, content)
            self._scan.metadata[record.name] = record.metadata
        elif opcode in (Opcode.MESSAGE_INDEX, Opcode.ATTACHMENT):
            check_content(opcode, content)

    def _keep(self, known: dict[int, Record], record: Record, verified: bool) -> None:
        key = (type(record), record.id)
        before = known.get(record.id)
        if before is None or (verified and key not in self._verified):
            known[record.id] = record
        elif before != record and not verified:
            raise ValueError("it contradicts another copy")
        if verified:
            self._verified.add(key)
