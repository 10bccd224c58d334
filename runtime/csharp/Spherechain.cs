// SPDX-License-Identifier: MIT
// Spherechain for C#: an asset, the short way for a game (Character), and the mirror between right- and left-handed axes.
// For netstandard 2.0, Unity 2021 and mono; C# 7. What is here allocates when it is made and never in a frame. Every error
// is a SpherechainException. docs/csharp.md is the guide.
using System;
using System.IO;
using System.Runtime.InteropServices;
using System.Text;
using System.Threading;

namespace Spherechain
{
    /// <summary>What the library refuses: a code, the field that it is about, and a sentence.</summary>
    public sealed class SpherechainException : Exception
    {
        public Code Code { get; private set; }
        public Field Field { get; private set; }
        /// <summary>As the C headers spell it: "pose.bones".</summary>
        public string FieldName { get; private set; }

        internal SpherechainException(Code code, Field field, string text) : base(text)
        {
            Code = code;
            Field = field;
            FieldName = Text.FieldOf(field);
        }
    }

    /// <summary>Texts and checks that the classes share.</summary>
    internal static unsafe class Text
    {
        internal const int MessageSize = 256;

        internal static string Of(byte* text)
        {
            if (text == null) return null;
            int length = 0;
            while (text[length] != 0) ++length;
            return length == 0 ? "" : Encoding.UTF8.GetString(text, length);
        }

        internal static string FieldOf(Field field)
        {
            // Without the library there are no texts, but there is an exception to throw.
            try { return Of(Native.sc_field_name(field)); } catch (DllNotFoundException) { return field.ToString(); }
        }

        internal static void Check(Status status, byte* message = null)
        {
            if (status.Code == Code.Ok) return;
            string text = Of(message);
            if (string.IsNullOrEmpty(text))
            {
                text = Of(Native.sc_code_text(status.Code));
                if (status.Field != Field.None) text = Of(Native.sc_field_name(status.Field)) + ": " + text;
            }
            throw new SpherechainException(status.Code, status.Field, text);
        }

        internal static UIntPtr Size(int count) { return new UIntPtr((uint)count); }
        internal static int Int(UIntPtr size) { return checked((int)size.ToUInt64()); }

        internal static void Require(object value, Field field, string what)
        {
            if (value == null) throw new SpherechainException(Code.Null, field, what + " is null");
        }
    }

    /// <summary>Memory that the garbage collector neither moves nor sees. 64-byte alignment, filled with zeros.</summary>
    internal sealed unsafe class Memory : IDisposable
    {
        internal byte* Data { get; private set; }
        internal long Size { get; private set; }
        IntPtr block;

        internal Memory(long size)
        {
            block = Marshal.AllocHGlobal(new IntPtr(size + 64));
            Data = (byte*)(((ulong)block.ToInt64() + 63) & ~63ul);
            Size = size;
            for (long i = 0; i < size; ++i) Data[i] = 0;
        }

        internal ulong* Words { get { return (ulong*)Data; } }
        internal UIntPtr WordCount { get { return new UIntPtr((ulong)(Size / 8)); } }

        public void Dispose()
        {
            Marshal.FreeHGlobal(block);
            block = IntPtr.Zero;
            Data = null;
            Size = 0;
            GC.SuppressFinalize(this);
        }

        ~Memory() { Marshal.FreeHGlobal(block); }
    }

    /// <summary>How many floats a matrix of a layout has; the skeleton of an engine as the library takes it.</summary>
    internal sealed unsafe class Joints : IDisposable
    {
        readonly Memory names, bones;
        GCHandle matrices;
        internal readonly int Count;

        internal static int Floats(MatrixLayout layout)
        {
            if (layout == MatrixLayout.Rows3x4 || layout == MatrixLayout.Columns3x4) return 12;
            if (layout == MatrixLayout.Rows4x4 || layout == MatrixLayout.Columns4x4) return 16;
            throw new SpherechainException(Code.BadValue, Field.BoneLayout, "say how the matrices lie in memory: a MatrixLayout");
        }

        internal Joints(string[] joints, float[] inverseBinds, MatrixLayout layout)
        {
            Count = joints == null ? 0 : joints.Length;
            int size = 0;
            int floats = inverseBinds == null ? 0 : Floats(layout);
            for (int i = 0; i < Count; ++i)
            {
                Text.Require(joints[i], Field.Joints, "the name of joint " + i);
                size += Encoding.UTF8.GetByteCount(joints[i]) + 1;
            }
            if (inverseBinds != null && inverseBinds.Length < Count * floats)
            {
                throw new SpherechainException(Code.TooSmall, Field.Joints, "fewer inverse bind matrices than joints");
            }
            names = new Memory(size);
            bones = new Memory((long)Count * sizeof(Native.Bone));
            float* first = null;
            if (inverseBinds != null)
            {
                matrices = GCHandle.Alloc(inverseBinds, GCHandleType.Pinned);
                first = (float*)matrices.AddrOfPinnedObject();
            }
            byte* name = names.Data;
            for (int i = 0; i < Count; ++i)
            {
                byte[] utf8 = Encoding.UTF8.GetBytes(joints[i]);
                Marshal.Copy(utf8, 0, new IntPtr(name), utf8.Length);
                Bones[i].Name = name;
                Bones[i].InverseBind = first == null ? null : first + (long)i * floats;
                name += utf8.Length + 1;
            }
        }

        internal Native.Bone* Bones { get { return (Native.Bone*)bones.Data; } }

        public void Dispose()
        {
            names.Dispose();
            bones.Dispose();
            if (matrices.IsAllocated) matrices.Free();
        }
    }

    /// <summary>A baked character, read only: any number of threads may share one. Its numbers and names are read once.</summary>
    public sealed unsafe class Asset : IDisposable
    {
        internal Native.Asset* View { get; private set; }
        readonly Memory memory;  // null where another object owns the asset
        internal readonly object Owner;  // kept from the garbage collector
        readonly Native.AssetInfo info;

        public int SphereCount { get { return Text.Int(info.SphereCount); } }
        public int BoneCount { get { return Text.Int(info.BoneCount); } }
        public int PartCount { get { return Text.Int(info.PartCount); } }
        public int MorphCount { get { return Text.Int(info.MorphCount); } }
        public int VertexCount { get { return Text.Int(info.VertexCount); } }
        public int TriangleCount { get { return Text.Int(info.TriangleCount); } }
        public float MetresPerUnit { get { return info.MetresPerUnit; } }
        public float Height { get { return info.Height; } }
        /// <summary>The character's own axes: Left x Up = Forward, in the source's right-handed space.</summary>
        public Vec3 Origin { get { return info.Origin; } }
        public Vec3 Left { get { return info.Left; } }
        public Vec3 Up { get { return info.Up; } }
        public Vec3 Forward { get { return info.Forward; } }
        public string Writer { get; private set; }
        public string SourceFile { get; private set; }
        public string SourceSha256 { get; private set; }
        public string Settings { get; private set; }
        /// <summary>Names by number. The name of the bone for vertices that no bone moves is empty.</summary>
        public string[] PartNames { get; private set; }
        public string[] BoneNames { get; private set; }
        public string[] MorphNames { get; private set; }

        /// <summary>Copies the file's bytes and verifies them. Hostile bytes are refused or harmless.</summary>
        public Asset(byte[] file)
        {
            Text.Require(file, Field.Data, "the file");
            memory = new Memory(sizeof(Native.Asset) + (long)file.Length);
            View = (Native.Asset*)memory.Data;
            byte* data = memory.Data + sizeof(Native.Asset);  // 1024 bytes: the alignment stays
            Marshal.Copy(file, 0, new IntPtr(data), file.Length);
            byte* message = stackalloc byte[Text.MessageSize];
            message[0] = 0;
            Text.Check(Native.sc_asset_open(View, Native.AbiVersion, data, Text.Size(file.Length), message,
                                            Text.Size(Text.MessageSize)), message);
            info = Native.sc_asset_get_info(View);
            ReadNames();
        }

        public Asset(string path) : this(File.ReadAllBytes(path)) { }

        internal Asset(Native.Asset* view, object owner)
        {
            View = view;
            Owner = owner;
            info = Native.sc_asset_get_info(view);
            ReadNames();
        }

        void ReadNames()
        {
            Writer = Text.Of(info.Writer);
            SourceFile = Text.Of(info.SourceFile);
            SourceSha256 = Text.Of(info.SourceSha256);
            Settings = Text.Of(info.Settings);
            PartNames = new string[PartCount];
            for (int i = 0; i < PartNames.Length; ++i) PartNames[i] = Text.Of(Native.sc_asset_part(View, Text.Size(i)).Name);
            BoneNames = new string[BoneCount];
            for (int i = 0; i < BoneNames.Length; ++i) BoneNames[i] = Text.Of(Native.sc_asset_bone(View, Text.Size(i)).Name);
            MorphNames = new string[MorphCount];
            for (int i = 0; i < MorphNames.Length; ++i) MorphNames[i] = Text.Of(Native.sc_asset_morph_name(View, Text.Size(i)));
        }

        internal Native.Asset* Open()
        {
            if (View == null) throw new SpherechainException(Code.NotOpen, Field.Asset, "the asset is disposed");
            return View;
        }

        /// <summary>The bone that a part follows, or -1.</summary>
        public int PartBone(int part) { return At(part, PartCount, Native.sc_asset_part(Open(), Index(part)).Bone); }
        /// <summary>The part that a part hangs on, or -1.</summary>
        public int PartParent(int part) { return At(part, PartCount, Native.sc_asset_part(Open(), Index(part)).Parent); }
        public Side PartSide(int part) { return At(part, PartCount, Native.sc_asset_part(Open(), Index(part)).Side); }
        /// <summary>A sphere at rest, in source units.</summary>
        public RestSphere RestSphere(int sphere) { return At(sphere, SphereCount, Native.sc_asset_sphere(Open(), Index(sphere))); }

        /// <summary>From the rest pose to the bone's space: 12 floats, Rows3x4, written to `matrix` from `at` on.</summary>
        public void InverseBind(int bone, float[] matrix, int at = 0)
        {
            float* found = Native.sc_asset_bone(Open(), Index(bone)).InverseBind;
            At(bone, BoneCount, 0);
            Text.Require(matrix, Field.Output, "the matrix");
            if (at < 0 || at > matrix.Length - 12) throw new SpherechainException(Code.TooSmall, Field.Output, "12 floats are written");
            for (int i = 0; i < 12; ++i) matrix[at + i] = found == null ? (i % 5 == 0 ? 1 : 0) : found[i];
            GC.KeepAlive(this);
        }

        static UIntPtr Index(int index) { return index < 0 ? new UIntPtr(uint.MaxValue) : Text.Size(index); }

        T At<T>(int index, int count, T value)
        {
            GC.KeepAlive(this);
            if (index >= 0 && index < count) return value;
            throw new SpherechainException(Code.BadValue, Field.Index, index + " is none of " + count);
        }

        /// <summary>Nothing may use the asset any more. The asset of a Character goes with that.</summary>
        public void Dispose()
        {
            if (memory == null) return;
            View = null;
            memory.Dispose();
        }

        internal void Close() { View = null; }
    }

    /// <summary>The short way for a game: an asset, its binding to the engine's joints, and its working memory. One object
    /// serves any number of characters of one asset, one at a time: make one a thread. A second thread at the same time gets
    /// an exception.</summary>
    public sealed unsafe class Character : IDisposable
    {
        IntPtr handle;
        int busy;

        public Asset Asset { get; private set; }
        /// <summary>What the last FindPenetrations() found: the first PenetrationCount entries. It stays the same array.</summary>
        public Penetration[] Penetrations { get; private set; }
        public int PenetrationCount { get; private set; }
        /// <summary>What the last FindContacts() found: the first ContactCount entries. It stays the same array.</summary>
        public PartContact[] Contacts { get; private set; }
        public int ContactCount { get; private set; }

        /// <summary>`file`: the .sphc file's bytes; they are copied. `joints`: the names of the engine's joints in the order of
        /// its palette; null: palettes come in the asset's order. `inverseBinds`: a matrix for each joint, in `layout`; null:
        /// not compared. With them, another rest pose, unit or handedness is refused (Code.OtherBind).</summary>
        public Character(byte[] file, string[] joints = null, float[] inverseBinds = null,
                         MatrixLayout layout = MatrixLayout.LayoutUnset)
        {
            Text.Require(file, Field.Data, "the file");
            byte* message = stackalloc byte[Text.MessageSize];
            message[0] = 0;
            using (Joints taken = new Joints(joints, inverseBinds, layout))
            {
                IntPtr made = IntPtr.Zero;
                Status status;
                // The library copies from memory that is aligned.
                using (Memory bytes = new Memory(file.Length))
                {
                    Marshal.Copy(file, 0, new IntPtr(bytes.Data), file.Length);
                    status = Native.sc_character_create(
                        Native.AbiVersion, bytes.Data, Text.Size(file.Length), joints == null ? null : taken.Bones,
                        Text.Size(taken.Count), inverseBinds == null ? MatrixLayout.Columns4x4 : layout, &made, message,
                        Text.Size(Text.MessageSize));
                }
                Text.Check(status, message);
                handle = made;
            }
            Asset = new Asset(Native.sc_character_asset(handle), this);
            int pairs = Asset.PartCount * (Asset.PartCount + 1) / 2;
            Penetrations = new Penetration[pairs];
            Contacts = new PartContact[pairs];
        }

        /// <summary>For the first run: `palette` of the bind pose, the character off the origin and turned. Throws
        /// (Code.OtherBind) where the matrices are not skinning matrices of this character, and names the bone.</summary>
        public void CheckRest(float[] palette, MatrixLayout layout)
        {
            Text.Require(palette, Field.Bones, "the palette");
            byte* message = stackalloc byte[Text.MessageSize];
            message[0] = 0;
            Enter();
            try
            {
                fixed (float* first = palette)
                {
                    Native.Pose pose = PoseOf(first, palette.Length / Joints.Floats(layout), layout);
                    Text.Check(Native.sc_character_check_rest(handle, &pose, message, Text.Size(Text.MessageSize)), message);
                }
            }
            finally { Leave(); }
        }

        /// <summary>Which pairs of body parts intersect, with depth and direction. `palette`: for each joint the skinning
        /// matrix, world times inverse bind. Returns PenetrationCount. Code.Overflow: so much intersects that there is no room
        /// to measure; ask FindContacts().</summary>
        public int FindPenetrations(float[] palette, MatrixLayout layout)
        {
            Text.Require(palette, Field.Bones, "the palette");
            fixed (float* first = palette) return FindPenetrations(first, palette.Length / Joints.Floats(layout), layout);
        }

        public int FindPenetrations(float* palette, int count, MatrixLayout layout)
        {
            PenetrationCount = 0;
            Enter();
            try
            {
                Native.Pose pose = PoseOf(palette, count, layout);
                Penetration* found = null;
                UIntPtr size;
                Text.Check(Native.sc_character_penetrations(handle, &pose, &found, &size));
                int n = Text.Int(size);
                if (n > Penetrations.Length) Penetrations = new Penetration[n];  // never: there are no more pairs of parts
                for (int i = 0; i < n; ++i) Penetrations[i] = found[i];
                return PenetrationCount = n;
            }
            finally { Leave(); }
        }

        /// <summary>Which pairs of body parts intersect, with a box around the place. Cheaper. Returns ContactCount.</summary>
        public int FindContacts(float[] palette, MatrixLayout layout)
        {
            Text.Require(palette, Field.Bones, "the palette");
            fixed (float* first = palette) return FindContacts(first, palette.Length / Joints.Floats(layout), layout);
        }

        public int FindContacts(float* palette, int count, MatrixLayout layout)
        {
            ContactCount = 0;
            Enter();
            try
            {
                Native.Pose pose = PoseOf(palette, count, layout);
                PartContact* found = null;
                UIntPtr size;
                Text.Check(Native.sc_character_contacts(handle, &pose, &found, &size));
                int n = Text.Int(size);
                if (n > Contacts.Length) Contacts = new PartContact[n];
                for (int i = 0; i < n; ++i) Contacts[i] = found[i];
                return ContactCount = n;
            }
            finally { Leave(); }
        }

        internal static Native.Pose PoseOf(float* palette, int count, MatrixLayout layout)
        {
            Native.Pose pose = default(Native.Pose);
            pose.Bones = palette;
            pose.BoneCount = Text.Size(count);
            pose.BoneLayout = layout;
            return pose;
        }

        void Enter()
        {
            if (Interlocked.CompareExchange(ref busy, 1, 0) != 0)
            {
                throw new SpherechainException(Code.Aliased, Field.Scratch, "the character is in use: make one a thread");
            }
            if (handle != IntPtr.Zero) return;
            busy = 0;
            throw new SpherechainException(Code.NotOpen, Field.Asset, "the character is disposed");
        }

        void Leave()
        {
            Volatile.Write(ref busy, 0);
            GC.KeepAlive(this);
        }

        public void Dispose()
        {
            if (handle == IntPtr.Zero) return;
            Enter();
            Native.sc_character_destroy(handle);
            handle = IntPtr.Zero;
            Asset.Close();
            Leave();
            GC.SuppressFinalize(this);
        }

        ~Character() { if (handle != IntPtr.Zero) Native.sc_character_destroy(handle); }
    }

    public enum Axis { None, X, Y, Z }

    /// <summary>Between the source file's right-handed space and an engine's left-handed one, whose importer turned one axis
    /// around and perhaps changed the unit. Unity's FBX importer, glTFast, UnityGLTF and UniVRM 1.0 turn X. The same call goes
    /// both ways for the axis; `scale` is engine units a source unit.</summary>
    public static class Mirror
    {
        /// <summary>A Columns4x4 matrix from the engine's space to the source's, in place: the translation is divided by
        /// `scale`. For the palette, and for inverse bind matrices.</summary>
        public static void ToSource(float[] matrices, int at, Axis axis, float scale = 1)
        {
            int turned = (int)axis - 1;
            for (int column = 0; column < 4; ++column)
            {
                for (int row = 0; row < 3; ++row)
                {
                    float sign = (row == turned) != (column == turned) ? -1 : 1;
                    matrices[at + 4 * column + row] *= column == 3 ? sign / scale : sign;
                }
            }
        }

        /// <summary>A point of a result, from the source's space to the engine's.</summary>
        public static Vec3 PointToEngine(Vec3 p, Axis axis, float scale = 1)
        {
            Vec3 d = DirectionToEngine(p, axis);
            d.X *= scale;
            d.Y *= scale;
            d.Z *= scale;
            return d;
        }

        public static Vec3 DirectionToEngine(Vec3 d, Axis axis)
        {
            if (axis == Axis.X) d.X = -d.X;
            if (axis == Axis.Y) d.Y = -d.Y;
            if (axis == Axis.Z) d.Z = -d.Z;
            return d;
        }
    }
}
