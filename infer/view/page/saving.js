// Files that the server sends: handed to the browser to keep.

export function keepFile(header, bytes) {
  const address = URL.createObjectURL(new Blob([bytes], { type: header.media }));
  const link = document.createElement("a");
  link.href = address;
  link.download = header.name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10000);
}
